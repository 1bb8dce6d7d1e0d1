// SPDX-License-Identifier: Apache-2.0
#include "net/secret_file.h"

#include <cerrno>
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

void make_secret_folder(const fs::path& folder) {
  if (fs::create_directories(folder)) fs::permissions(folder, fs::perms::owner_all);
}

fs::path temporary_beside(const fs::path& file) { return file.string() + "." + std::to_string(std::random_device()()); }

void replace_secret(const fs::path& file, const std::string& text) {
  make_secret_folder(file.parent_path());
  const fs::path temporary = temporary_beside(file);
  write_secret(temporary, text);
  fs::rename(temporary, file);
}

}  // namespace iota::net
