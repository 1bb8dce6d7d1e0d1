// SPDX-License-Identifier: Apache-2.0
// The secret in the page's URL: 128 random bits as 32 hexadecimal digits, the same after a restart.
#pragma once

#include "net/secret_file.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace iota::net {

/// 32 new hexadecimal digits from the system's random source.
std::string make_token();

/// The token kept in `folder`/token, made (mode 0600, written atomically) if it is missing or damaged. Two processes
/// that start together get the same one. Throws std::system_error if it can be neither read nor written.
std::string load_or_make_token(const std::filesystem::path& folder = state_folder());

/// Replaces the kept token: users of the old one need the new address. Throws as load_or_make_token.
std::string renew_token(const std::filesystem::path& folder = state_folder());

/// Whether they are equal, in a time that depends only on the length of `given`.
bool equal_in_constant_time(std::string_view given, std::string_view expected);

}  // namespace iota::net
