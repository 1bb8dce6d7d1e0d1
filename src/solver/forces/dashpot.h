// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/forces/force_arm.h"

#include <algorithm>

namespace iota::solver {

/// The axis of damping between two points in a step from e0 to e1. In the mid-point rule n is along e0 + e1, where the
/// force has no moment and where a rotation has no rate: n.(e1 - e0) = (|e1|^2 - |e0|^2) / |e0 + e1|. Along e0, which the
/// end-point rule takes as that is constant in a step, a damped dumbbell at 5 rad/s lost 1.5 % of its spin a second. Ends
/// that rest in one place (`may_meet`) keep it nevertheless: where they pass each other e0 + e1 has any direction, and stiff
/// springs of straight angles did not converge.
struct Dashpot {
  Vec3 n;
  double along = 0;   ///< change of the distance, m
  double length = 0;  ///< of the vector along n
  bool turns;         ///< n depends on e1

  Dashpot(const Vec3& e0, const Vec3& e1, const ForceStage& s, bool may_meet = false)
      : turns(s.midpoint && !s.instant && !may_meet) {
    const Vec3 axis = s.instant ? e1 : turns ? e0 + e1 : e0;
    length = norm(axis) + 1e-300;
    n = (1 / length) * axis;
    along = dot(n, e1 - e0);
  }

  /// Minus the derivative by e1 of the force -pull n. rate: derivative of the pull by `along`.
  Mat3 stiffness_matrix(const Vec3& e1, double rate, double pull, const ForceStage& s) const {
    if (!turns) return rate * Mat3::outer(n, n);
    double across = pull / length;
    if (s.clamp) across = std::max(across, 0.0);
    return Mat3::outer(n, (rate / length) * (2 * e1 - along * n) - across * n) + Mat3::diagonal(across);
  }
};

}  // namespace iota::solver
