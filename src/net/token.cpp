// SPDX-License-Identifier: Apache-2.0
#include "net/token.h"

#include "base/replace_file.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <system_error>

namespace iota::net {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t token_digits = 32;
constexpr auto owner_only = fs::perms::owner_read | fs::perms::owner_write;

bool is_token(std::string_view text) {
  return text.size() == token_digits &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

/// The token in `file`, or an empty string if there is no usable one.
std::string read_token(const fs::path& file) {
  std::string text = read_file(file);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return is_token(text) ? text : std::string();
}

}  // namespace

std::string make_token() {
  std::random_device source;
  std::string token;
  for (std::size_t i = 0; i < token_digits; i += 8) {
    const auto bits = static_cast<std::uint32_t>(source());
    for (int shift = 28; shift >= 0; shift -= 4) token += "0123456789abcdef"[(bits >> shift) & 15U];
  }
  return token;
}

std::string load_or_make_token(const fs::path& folder) {
  const fs::path file = folder / "token";
  if (std::string found = read_token(file); !found.empty()) {
    fs::permissions(file, owner_only);
    return found;
  }
  make_secret_folder(folder);
  std::string token = make_token();
  const fs::path temporary = name_beside(file);
  write_secret(temporary, token + "\n");
  // A link fails if another process was faster, so that both use that one's token; a rename would not fail.
  std::error_code no_link;
  fs::create_hard_link(temporary, file, no_link);
  if (no_link) {
    if (std::string found = read_token(file); !found.empty()) {
      fs::remove(temporary);
      return found;
    }
    fs::rename(temporary, file);  // damaged, or a file system without links
    sync_folder(folder);
    return token;
  }
  fs::remove(temporary);
  sync_folder(folder);
  return token;
}

std::string renew_token(const fs::path& folder) {
  std::string token = make_token();
  replace_secret(folder / "token", token + "\n");
  return token;
}

bool equal_in_constant_time(std::string_view given, std::string_view expected) {
  if (expected.empty()) return false;
  unsigned difference = given.size() == expected.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    difference |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(expected[i % expected.size()]);
  }
  return difference == 0;
}

}  // namespace iota::net
