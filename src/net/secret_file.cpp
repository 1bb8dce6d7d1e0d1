// SPDX-License-Identifier: Apache-2.0
#include "net/secret_file.h"

#include "base/replace_file.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>

namespace iota::net {

namespace fs = std::filesystem;

fs::path state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  // By the XDG specification, a relative path is ignored.
  if (state != nullptr && fs::path(state).is_absolute()) return fs::path(state) / "iota";
#ifdef _WIN32
  const char* home = std::getenv("LOCALAPPDATA");
  if (home != nullptr && *home != '\0') return fs::path(home) / "iota";
#else
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0') return fs::path(home) / ".local" / "state" / "iota";
#endif
  throw std::runtime_error("no folder to keep secrets in: set HOME or XDG_STATE_HOME");
}

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_secret(const fs::path& file, const std::string& text) {
  write_new_file(file, std::as_bytes(std::span(text)), Readers::owner);
}

void make_secret_folder(const fs::path& folder) {
  if (fs::create_directories(folder)) fs::permissions(folder, fs::perms::owner_all);
}

void replace_secret(const fs::path& file, const std::string& text) {
  make_secret_folder(file.parent_path());
  replace_file(file, std::as_bytes(std::span(text)), Readers::owner);
}

}  // namespace iota::net
