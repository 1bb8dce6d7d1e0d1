// SPDX-License-Identifier: Apache-2.0
#include "net/token.h"

#include "net/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace iota::net {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

TEST(Token, is_made_once_and_kept) {
  const TemporaryFolder folder;
  const fs::path state = folder.path() / "state" / "iota";
  const std::string token = load_or_make_token(state);
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_EQ(load_or_make_token(state), token);
  EXPECT_EQ(std::distance(fs::directory_iterator(state), fs::directory_iterator()), 1);
}

TEST(Token, is_another_one_once_it_was_renewed) {
  const TemporaryFolder folder;
  const std::string before = load_or_make_token(folder.path() / "iota");
  const std::string after = renew_token(folder.path() / "iota");
  EXPECT_NE(after, before);
  EXPECT_EQ(after.size(), 32U);
  EXPECT_EQ(load_or_make_token(folder.path() / "iota"), after);
}

TEST(Token, is_readable_by_its_owner_only) {
  const TemporaryFolder folder;
  const auto mode_of = [&] { return fs::status(folder.path() / "token").permissions(); };
  load_or_make_token(folder.path());
  EXPECT_EQ(mode_of(), fs::perms::owner_read | fs::perms::owner_write);
  fs::permissions(folder.path() / "token", fs::perms::all);
  load_or_make_token(folder.path());
  EXPECT_EQ(mode_of(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(Token, is_made_anew_when_its_file_is_damaged) {
  const TemporaryFolder folder;
  for (const char* contents : {"", "short", "zz345678901234567890123456789012", "0123456789abcdef0123456789abcdef00"}) {
    folder.write("token", contents);
    const std::string token = load_or_make_token(folder.path());
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(load_or_make_token(folder.path()), token);
  }
}

TEST(Token, is_the_same_for_all_that_start_at_once) {
  const TemporaryFolder folder;
  std::vector<std::string> tokens(8);
  std::vector<std::thread> threads;
  for (auto& token : tokens) threads.emplace_back([&] { token = load_or_make_token(folder.path()); });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(std::set<std::string>(tokens.begin(), tokens.end()).size(), 1U);
}

TEST(Token, says_so_when_it_cannot_be_kept) {
  const TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_THROW(load_or_make_token(folder.path() / "file" / "iota"), std::system_error);
}

TEST(Token, is_compared_whole) {
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  EXPECT_FALSE(equal_in_constant_time("abd", "abc"));
  EXPECT_FALSE(equal_in_constant_time("ab", "abc"));
  EXPECT_FALSE(equal_in_constant_time("abcabc", "abc"));
  EXPECT_FALSE(equal_in_constant_time("", "abc"));
  EXPECT_FALSE(equal_in_constant_time("", ""));
}

}  // namespace
}  // namespace iota::net
