// SPDX-License-Identifier: Apache-2.0
// Files that survive a crash of the process and a power cut: a reader finds the old one or the new one, complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace iota {

enum class Readers { all, owner };

/// Writes a new file to the disk, not only to the system's memory. `owner`: it is created with mode 0600, so that no
/// other user can open it at any time. Throws std::system_error if it cannot be written or exists already.
void write_new_file(const std::filesystem::path& file, std::span<const std::byte> bytes, Readers readers);

/// Replaces a file by a new one with these bytes, or makes it; what an earlier call could not complete is removed after
/// an hour. Throws std::system_error; the file is then unchanged.
void replace_file(const std::filesystem::path& file, std::span<const std::byte> bytes, Readers readers);

/// Writes the entries of a folder to the disk: until then, a renamed file may come back under its old name.
void sync_folder(const std::filesystem::path& folder);

/// A name beside `file` for its successor, that no other process uses.
std::filesystem::path name_beside(const std::filesystem::path& file);

}  // namespace iota
