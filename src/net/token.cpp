// SPDX-License-Identifier: Apache-2.0
#include "net/token.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <system_error>

#ifndef _WIN32
#include <fcntl.h>
#include <unistd.h>
#endif

namespace iota::net {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t token_digits = 32;
constexpr auto owner_only = fs::perms::owner_read | fs::perms::owner_write;

bool is_token(std::string_view text) {
  return text.size() == token_digits &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

/// The token in `file`, or an empty string when there is none that can be used.
std::string read_token(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return is_token(text) ? text : std::string();
}

/// Writes a file that nobody else could open at any moment: the mode is given when it is created.
void write_secret(const fs::path& file, const std::string& text) {
#ifdef _WIN32
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::system_error(errno, std::generic_category(), "cannot write " + file.string());
#else
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "cannot write " + file.string());
  const bool written = ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int reason = errno;
  if ((::close(descriptor) != 0) || !written) {
    throw std::system_error(written ? errno : reason, std::generic_category(), "cannot write " + file.string());
  }
#endif
}

}  // namespace

fs::path state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  // The XDG specification: a relative path there is to be ignored.
  if (state != nullptr && fs::path(state).is_absolute()) return fs::path(state) / "iota";
#ifdef _WIN32
  const char* home = std::getenv("LOCALAPPDATA");
  if (home != nullptr && *home != '\0') return fs::path(home) / "iota";
#else
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return fs::path(home) / ".local" / "state" / "iota";
#endif
  throw std::runtime_error("no folder to keep the token in: set HOME or XDG_STATE_HOME");
}

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
  if (fs::create_directories(folder)) fs::permissions(folder, fs::perms::owner_all);
  std::string token = make_token();
  const fs::path temporary = folder / ("token." + make_token());
  write_secret(temporary, token + "\n");
  // A link fails when another process was faster, so that both end up with that one's token; a rename would not.
  std::error_code no_link;
  fs::create_hard_link(temporary, file, no_link);
  if (no_link) {
    if (std::string found = read_token(file); !found.empty()) {
      fs::remove(temporary);
      return found;
    }
    fs::rename(temporary, file);  // damaged, or a file system without links
    return token;
  }
  fs::remove(temporary);
  return token;
}

std::string renew_token(const fs::path& folder) {
  if (fs::create_directories(folder)) fs::permissions(folder, fs::perms::owner_all);
  std::string token = make_token();
  const fs::path temporary = folder / ("token." + make_token());
  write_secret(temporary, token + "\n");
  fs::rename(temporary, folder / "token");
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
