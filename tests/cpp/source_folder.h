// SPDX-License-Identifier: Apache-2.0
// Some tests read golden bytes, scripts and lists, wherever the binary is started.
#pragma once

#include <filesystem>

namespace iota {

/// The root of the sources from which the tests were built.
std::filesystem::path source_folder();

}  // namespace iota
