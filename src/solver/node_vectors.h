// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cstdint>

namespace iota::solver {

/// A vector of each node, where it stands among the unknowns: a list of their own would be copied in each step.
struct NodeVectors {
  const double* unknowns;
  const std::uint32_t* first;  ///< unknown of each node

  Vec3 operator[](std::uint32_t node) const {
    const double* const v = unknowns + first[node];
    return {v[0], v[1], v[2]};
  }
};

}  // namespace iota::solver
