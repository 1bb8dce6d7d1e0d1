// SPDX-License-Identifier: Apache-2.0
#include "source_folder.h"

// A unit of its own: a path in the flags of all tests would keep a compiler cache from serving two checkouts.
std::filesystem::path iota::source_folder() { return IOTA_SOURCE_DIR; }
