// SPDX-License-Identifier: Apache-2.0
#include "base/replace_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <random>
#include <string>
#include <system_error>

#ifndef _WIN32
#include <fcntl.h>
#include <unistd.h>
#endif

namespace iota {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view ending = ".part";

[[noreturn]] void fail(int reason, const fs::path& file) {
  throw std::system_error(reason, std::generic_category(), "cannot write " + file.string());
}

/// Whether `name` is one of name_beside(file).
bool is_successor(const std::string& name, const std::string& file) {
  if (!name.starts_with(file + ".") || !name.ends_with(ending) || name.size() <= file.size() + 1 + ending.size())
    return false;
  return std::all_of(name.begin() + static_cast<std::ptrdiff_t>(file.size()) + 1,
                     name.end() - static_cast<std::ptrdiff_t>(ending.size()),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// Nobody writes a file for an hour, so that an old successor is that of a process that was killed.
void remove_leftovers(const fs::path& file) {
  std::error_code error;
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  for (auto i = fs::directory_iterator(folder_of(file), error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    if (!is_successor(i->path().filename().string(), file.filename().string())) continue;
    std::error_code gone;
    if (fs::last_write_time(i->path(), gone) < old && !gone) fs::remove(i->path(), gone);
  }
}

}  // namespace

void write_new_file(const fs::path& file, std::span<const std::byte> bytes, Readers readers) {
#ifdef _WIN32
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) fail(errno, file);
#else
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, readers == Readers::owner ? 0600 : 0666);
  if (descriptor < 0) fail(errno, file);
  int reason = 0;
  while (!bytes.empty() && reason == 0) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0)
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      reason = errno;
  }
  if (reason == 0 && ::fsync(descriptor) != 0 && errno != EINVAL) reason = errno;  // EINVAL: a device, which has none
  if (::close(descriptor) != 0 && reason == 0) reason = errno;
  if (reason == 0) return;
  ::unlink(file.c_str());
  fail(reason, file);
#endif
}

void replace_file(const fs::path& file, std::span<const std::byte> bytes, Readers readers) {
  remove_leftovers(file);
  const fs::path fresh = name_beside(file);
  write_new_file(fresh, bytes, readers);
  std::error_code error;
  fs::rename(fresh, file, error);
  if (error) {
    std::error_code ignored;
    fs::remove(fresh, ignored);
    fail(error.value(), file);
  }
  sync_folder(folder_of(file));
}

void sync_folder([[maybe_unused]] const fs::path& folder) {
#ifndef _WIN32
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder that one may write to, but not list
  ::fsync(descriptor);
  ::close(descriptor);
#endif
}

fs::path name_beside(const fs::path& file) {
  return file.string() + "." + std::to_string(std::random_device()()) + std::string(ending);
}

}  // namespace iota
