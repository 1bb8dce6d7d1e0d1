// SPDX-License-Identifier: Apache-2.0
// Files that only their owner may read: the token and the key of the certificate.
#pragma once

#include <filesystem>
#include <string>

namespace iota::net {

/// $XDG_STATE_HOME/iota, or ~/.local/state/iota. Throws std::runtime_error if neither variable names a folder.
std::filesystem::path state_folder();

/// The content of a file; empty if it cannot be read.
std::string read_file(const std::filesystem::path& file);

/// Writes a new file that no other user can open at any time: it is created with its mode, 0600. Throws
/// std::system_error if it cannot be written or exists already.
void write_secret(const std::filesystem::path& file, const std::string& text);

/// Makes the folder of a secret, for its owner only, if it does not exist.
void make_secret_folder(const std::filesystem::path& folder);

/// Replaces a file by a secret atomically. Throws std::system_error.
void replace_secret(const std::filesystem::path& file, const std::string& text);

}  // namespace iota::net
