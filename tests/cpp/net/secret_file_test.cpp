// SPDX-License-Identifier: Apache-2.0
#include "net/secret_file.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <cstdlib>
#include <iterator>
#include <optional>
#include <system_error>

namespace iota::net {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("iota-secret-" + std::to_string(::getpid()));
  Folder() { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
};

constexpr fs::perms only_owner_file = fs::perms::owner_read | fs::perms::owner_write;

TEST(SecretFile, is_created_for_its_owner_alone_even_if_the_umask_allows_more) {
  const Folder folder;
  const mode_t before = ::umask(0);
  make_secret_folder(folder.path);
  write_secret(folder.path / "token", "abc");
  ::umask(before);
  EXPECT_EQ(fs::status(folder.path).permissions(), fs::perms::owner_all);
  EXPECT_EQ(fs::status(folder.path / "token").permissions(), only_owner_file);
  EXPECT_EQ(read_file(folder.path / "token"), "abc");
}

TEST(SecretFile, that_exists_is_never_written_into) {
  const Folder folder;
  make_secret_folder(folder.path);
  write_secret(folder.path / "token", "abc");
  EXPECT_THROW(write_secret(folder.path / "token", "def"), std::system_error);
  EXPECT_EQ(read_file(folder.path / "token"), "abc");
}

TEST(SecretFile, is_replaced_whole_and_leaves_nothing_beside_it) {
  const Folder folder;
  replace_secret(folder.path / "token", "a long one");
  replace_secret(folder.path / "token", "b");
  EXPECT_EQ(read_file(folder.path / "token"), "b");
  EXPECT_EQ(fs::status(folder.path / "token").permissions(), only_owner_file);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()), 1);
}

TEST(SecretFile, that_cannot_be_read_is_empty) { EXPECT_EQ(read_file(Folder().path / "token"), ""); }

/// Sets an environment variable, and restores it.
struct Variable {
  const char* name;
  std::optional<std::string> before;
  Variable(const char* name, const char* value) : name(name) {
    if (const char* const now = std::getenv(name)) before = now;
    ::setenv(name, value, 1);
  }
  ~Variable() { before ? ::setenv(name, before->c_str(), 1) : ::unsetenv(name); }
};

TEST(StateFolder, is_that_of_the_xdg_specification) {
  const Variable home("HOME", "/home/ada");
  {
    const Variable state("XDG_STATE_HOME", "/var/states");
    EXPECT_EQ(state_folder(), "/var/states/iota");
  }
  for (const char* const no_folder : {"", "relative/states"}) {
    const Variable state("XDG_STATE_HOME", no_folder);
    EXPECT_EQ(state_folder(), "/home/ada/.local/state/iota");
  }
  const Variable state("XDG_STATE_HOME", ""), nowhere("HOME", "");
  EXPECT_THROW((void)state_folder(), std::runtime_error);
}

}  // namespace
}  // namespace iota::net
