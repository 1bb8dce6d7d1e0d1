// SPDX-License-Identifier: Apache-2.0
// Files that only their owner may read: the token and the key of the certificate.
#pragma once

#include <filesystem>
#include <string>

namespace iota::net {

/// $XDG_STATE_HOME/iota, or ~/.local/state/iota. Throws std::runtime_error when neither variable names a folder.
std::filesystem::path state_folder();

/// All of a file; empty when it cannot be read.
std::string read_file(const std::filesystem::path& file);

/// Writes a new file that nobody else could open at any moment: its mode, 0600, is given when it is created.
/// Throws std::system_error where it cannot be written or is there already.
void write_secret(const std::filesystem::path& file, const std::string& text);

/// Makes the folder of a secret, for its owner only, if it is not there.
void make_secret_folder(const std::filesystem::path& folder);

/// A name beside `file` that no other process uses.
std::filesystem::path temporary_beside(const std::filesystem::path& file);

/// Puts a secret in place of a file, which is there whole or not at all. Throws std::system_error.
void replace_secret(const std::filesystem::path& file, const std::string& text);

}  // namespace iota::net
