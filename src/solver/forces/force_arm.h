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
  /// The sum of the sizes of the terms of its value, whose round-off is a share of it.
  double size(const Vec3* x) const {
    double sum = norm(origin);
    for (std::uint32_t i = 0; i < count; ++i) sum += std::abs(weights[i]) * norm(x[nodes[i]]);
    return sum;
  }
  /// Its rate for velocities v of the points.
  Vec3 rate(const Vec3* v) const {
    Vec3 sum;
    for (std::uint32_t i = 0; i < count; ++i) sum += weights[i] * v[nodes[i]];
    return sum;
  }
};

/// The evaluation of a force in a step: backward Euler at its end, the mid-point rule by a discrete gradient.
struct ForceStage {
  double h = 0;  ///< s
  bool midpoint = false;
  bool clamp = false;    ///< make stiffness blocks positive semi-definite
  bool instant = false;  ///< at the place e1 with the rate (e1 - e0)/h, not between e0 and e1
  /// With e0 = e1 minus the rate; work and dissipation are then powers.
  static ForceStage at_an_instant() { return {.h = 1, .instant = true}; }
};

}  // namespace iota::solver
