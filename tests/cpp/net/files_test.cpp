// SPDX-License-Identifier: Apache-2.0
// The token's file, the page's files, and the queue of frames: what the server rests on.
#include "net/out_queue.h"
#include "net/static_files.h"
#include "net/temporary_folder.h"
#include "net/token.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <system_error>
#include <thread>

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

TEST(StaticFiles, are_found_with_their_type) {
  const TemporaryFolder folder;
  folder.write("index.html", "<html>");
  folder.write("assets/main-1a2b.js", "x");
  folder.write("odd.xyz", "x");
  const auto index = find_static_file(folder.path(), "/");
  ASSERT_TRUE(index);
  EXPECT_EQ(index->mime_type, "text/html; charset=utf-8");
  EXPECT_EQ(index->cache_control, "no-cache");
  EXPECT_EQ(read_static_file(*index), "<html>");
  const auto script = find_static_file(folder.path(), "/assets/main-1a2b.js");
  ASSERT_TRUE(script);
  EXPECT_EQ(script->mime_type, "text/javascript; charset=utf-8");
  EXPECT_NE(script->cache_control.find("immutable"), std::string_view::npos);
  EXPECT_EQ(find_static_file(folder.path(), "/odd.xyz")->mime_type, "application/octet-stream");
}

TEST(StaticFiles, change_their_tag_when_they_change) {
  const TemporaryFolder folder;
  folder.write("index.html", "one");
  const std::string before = find_static_file(folder.path(), "/")->etag;
  EXPECT_EQ(find_static_file(folder.path(), "/")->etag, before);
  folder.write("index.html", "three");
  EXPECT_NE(find_static_file(folder.path(), "/")->etag, before);
}

TEST(StaticFiles, a_compressed_copy_is_found_for_who_takes_it) {
  const TemporaryFolder folder;
  folder.write("index.html", "<p>hello hello hello</p>");
  folder.write("index.html.gz", "gz");
  folder.write("index.html.br", "br!");
  const auto encoding = [&](std::string_view accepted) {
    return std::string(find_static_file(folder.path(), "/", accepted)->encoding);
  };
  EXPECT_EQ(encoding(""), "");
  EXPECT_EQ(encoding("identity, x-gzip"), "");
  EXPECT_EQ(encoding("gzip, deflate"), "gzip");
  EXPECT_EQ(encoding("gzip, deflate, br"), "br");
  EXPECT_EQ(encoding("br;q=0, gzip;q=0.5"), "gzip");
  EXPECT_EQ(encoding("gzip; q=0.0"), "");
  const auto copy = find_static_file(folder.path(), "/", "br");
  EXPECT_EQ(copy->mime_type, "text/html; charset=utf-8");
  EXPECT_EQ(read_static_file(*copy), "br!");
  EXPECT_NE(copy->etag, find_static_file(folder.path(), "/")->etag);
}

TEST(StaticFiles, outside_of_the_folder_are_not_found) {
  const TemporaryFolder folder;
  folder.write("secret.txt", "x");
  folder.write("page/index.html", "x");
  folder.write("page/.hidden", "x");
  folder.write("page/sub/a.txt", "x");
  folder.write("page2/a.txt", "x");
  fs::create_symlink(folder.path() / "secret.txt", folder.path() / "page" / "link.txt");
  fs::create_directory_symlink(folder.path() / "page2", folder.path() / "page" / "other");
  const fs::path page = folder.path() / "page";
  for (const std::string path : {"", "index.html", "/../secret.txt", "/sub/../../secret.txt", "/./index.html",
                                 "//index.html", "/.hidden", "/link.txt", "/other/a.txt", "/sub", "/sub/", "/nothing",
                                 "/..", "/..\\secret.txt", "/C:/secret.txt", "/index.html/"}) {
    EXPECT_FALSE(find_static_file(page, path)) << path;
  }
  EXPECT_FALSE(find_static_file(page, std::string("/index.html\0.txt", 16)));
  EXPECT_FALSE(find_static_file(page, "/" + (folder.path() / "secret.txt").string()));
  EXPECT_FALSE(find_static_file(folder.path() / "nowhere", "/"));
  EXPECT_TRUE(find_static_file(page, "/sub/a.txt"));
}

Frame frame_of(std::size_t size, std::uint8_t value) {
  return std::make_shared<const std::vector<std::uint8_t>>(size, value);
}

TEST(OutQueue, keeps_the_order_and_the_newest_of_each_key) {
  OutQueue queue(100);
  EXPECT_TRUE(queue.push(frame_of(1, 1)));
  EXPECT_TRUE(queue.push(frame_of(1, 2), "a"));
  EXPECT_TRUE(queue.push(frame_of(1, 3)));
  EXPECT_TRUE(queue.push(frame_of(1, 4), "a"));
  std::vector<int> values;
  while (!queue.empty()) values.push_back(queue.pop()->front());
  EXPECT_EQ(values, (std::vector<int>{1, 4, 3}));
}

TEST(OutQueue, caps_only_what_adds_up) {
  OutQueue queue(100);
  EXPECT_TRUE(queue.push(frame_of(100000, 1), "scene"));
  EXPECT_TRUE(queue.push(frame_of(60, 2)));
  EXPECT_FALSE(queue.push(frame_of(60, 3)));
  queue.pop();
  queue.pop();
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.push(frame_of(100, 3)));
}

}  // namespace
}  // namespace iota::net
