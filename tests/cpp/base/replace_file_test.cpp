// SPDX-License-Identifier: Apache-2.0
#include "base/replace_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace iota {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("iota-replace-" + std::to_string(::getpid()));
  Folder() {
    fs::remove_all(path);
    fs::create_directory(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::ptrdiff_t count() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

void replace(const fs::path& file, const std::string& text) {
  replace_file(file, std::as_bytes(std::span(text)), Readers::all);
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(ReplaceFile, takes_the_place_of_the_old_one_and_leaves_nothing_beside_it) {
  const Folder folder;
  replace(folder.path / "a", std::string(1 << 20, 'x'));
  replace(folder.path / "a", "new");
  EXPECT_EQ(read(folder.path / "a"), "new");
  EXPECT_EQ(folder.count(), 1);
}

TEST(ReplaceFile, removes_what_a_killed_process_left_an_hour_ago_and_nothing_else) {
  const Folder folder;
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(2);
  for (const char* name : {"a.12.part", "a.part", "a.b.part", "ab.12.part", "a.12.party"}) {
    std::ofstream(folder.path / name) << "x";
    fs::last_write_time(folder.path / name, old);
  }
  std::ofstream(folder.path / "a.13.part") << "another process writes it";
  replace(folder.path / "a", "new");
  EXPECT_FALSE(fs::exists(folder.path / "a.12.part"));
  EXPECT_EQ(folder.count(), 6);
}

TEST(ReplaceFile, that_cannot_be_written_is_told_and_nothing_is_left) {
  const Folder folder;
  fs::create_directory(folder.path / "a");
  std::ofstream(folder.path / "a" / "b") << "x";
  EXPECT_THROW(replace(folder.path / "a", "new"), std::system_error);
  EXPECT_THROW(replace(folder.path / "none" / "a", "new"), std::system_error);
  EXPECT_EQ(folder.count(), 1);
}

}  // namespace
}  // namespace iota
