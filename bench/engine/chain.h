// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include "scenes/chain.h"

namespace iota::bench {

/// The benchmark's chain in a system of its own: links of 0.1 m and 0.1 kg along x (rods: 5 mm radius), the first end
/// nailed at the origin, at rest. The peers' chain (bench/peers/chain.py) is the same.
struct Chain {
  Chain(int links, bool rods, IntegrationMode mode)
      : system({.mode = mode, .threads = 1}), parts(scenes::make_chain(system, {.links = links, .rods = rods})) {}

  System system;
  scenes::Chain parts;
};

}  // namespace iota::bench
