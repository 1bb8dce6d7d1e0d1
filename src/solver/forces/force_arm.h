// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace iota::solver {

/// The argument of an implicit force: the vector e = sum_i w_i x_i - origin of a few points. A force F(e) acts on point
/// i as w_i F, so that momentum is kept if the weights sum to zero.
struct ForceArm {
  static constexpr int max_nodes = 4;
  std::array<std::uint32_t, max_nodes> nodes{};
  std::array<double, max_nodes> weights{};
  std::uint32_t count = 0;
  Vec3 origin;

  /// Whether it is a difference of points, with no end fixed in the world.
  bool is_internal() const {
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) sum += weights[i];
    return count > 1 && std::abs(sum) < 1e-9;
  }
  Vec3 value(const Vec3* x) const {
    Vec3 e = -1.0 * origin;
    for (std::uint32_t i = 0; i < count; ++i) e += weights[i] * x[nodes[i]];
    return e;
  }
};

/// The evaluation of a force in a step: backward Euler at its end, the mid-point rule by a discrete gradient.
struct ForceStage {
  double h = 0;  ///< s
  bool midpoint = false;
  bool clamp = false;  ///< make stiffness blocks positive semi-definite
};

}  // namespace iota::solver
