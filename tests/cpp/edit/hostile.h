// SPDX-License-Identifier: Apache-2.0
// How many damaged snapshots and recordings are tried: `make hostile` sets both numbers.
#pragma once

#include "tests/cpp/amount.h"

#include <cstdint>
#include <cstdlib>

namespace iota {

/// IOTA_HOSTILE_COUNT, or else `sampled(all)`.
inline int hostile_count(int all) {
  const char* const count = std::getenv("IOTA_HOSTILE_COUNT");
  return count ? std::atoi(count) : sampled(all);
}

/// IOTA_HOSTILE_SEED, or else 1.
inline std::uint64_t hostile_seed() {
  const char* const seed = std::getenv("IOTA_HOSTILE_SEED");
  return seed ? std::strtoull(seed, nullptr, 10) : 1;
}

}  // namespace iota
