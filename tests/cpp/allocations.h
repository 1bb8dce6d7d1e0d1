// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace iota {

/// How often this program has called operator new.
extern std::atomic<long> allocations;
/// How many bytes it has asked for, those given back included.
extern std::atomic<long> allocated_bytes;

}  // namespace iota
