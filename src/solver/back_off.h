// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace iota::solver {

/// Whether what has had no solution for this many steps is tried again: after 8, 16, ... 256 of them, then after each 256.
inline bool is_due(std::uint64_t steps) {
  constexpr std::uint64_t shortest_wait = 8, longest_wait = 256;
  return steps % longest_wait == 0 || (steps >= shortest_wait && (steps & (steps - 1)) == 0);
}

}  // namespace iota::solver
