// SPDX-License-Identifier: Apache-2.0
#include "net/static_files.h"

#include "net/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace iota::net {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

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

}  // namespace
}  // namespace iota::net
