// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace iota {

/// How often this program has called operator new.
extern std::atomic<long> allocations;

}  // namespace iota
