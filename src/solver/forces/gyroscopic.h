// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/forces/force_arm.h"

namespace iota::solver {

/// The gyroscopic force of a rod that spins about its axis. Its two points, e from the first to the second, have all
/// angular momentum except S e/|e| of the spin; forces on the axis do not change S. With em = (e0 + e1)/2 and s = S/|e|
/// F = s em x (e1 - e0)/h / |em|^2 on the second point, -F on the first, has the moment h em x F = -s (e1 - e0),
/// exactly minus the change of the spin's part, and does no work: energy and angular momentum are kept to round-off by
/// the mid-point rule.
/// Its derivative is antisymmetric. The symmetric matrix of the end-point scheme cannot contain it: there it is left
/// out, and Newton's method converges linearly by (S/It) h instead of quadratically; fast spins cost sub-steps.
struct GyroscopicForce {
  static constexpr bool is_external = false;
  ForceArm arm;
  double spin = 0;  ///< s, kg m/s

  static constexpr bool keeps_angular_momentum() { return true; }  // with the spin
  double energy(const Vec3&) const { return 0; }
  Vec3 force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const Vec3 em = s.instant ? e1 : 0.5 * (e0 + e1);
    return (spin / (s.h * (dot(em, em) + 1e-300))) * cross(e0, e1);  // em x (e1 - e0) = e0 x e1
  }
  double dissipation(const Vec3&, const Vec3&, const ForceStage&) const { return 0; }
  Mat3 stiffness_matrix(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    if (!s.midpoint) return {};
    const Vec3 em = 0.5 * (e0 + e1);
    const double by = 1 / (dot(em, em) + 1e-300), c = spin / s.h * by;
    Mat3 k = by * Mat3::outer(force(e0, e1, s), em);
    k.m[0][1] += c * e0.z, k.m[0][2] -= c * e0.y;  // -c [e0]x
    k.m[1][0] -= c * e0.z, k.m[1][2] += c * e0.x;
    k.m[2][0] += c * e0.y, k.m[2][1] -= c * e0.x;
    return k;
  }
};

}  // namespace iota::solver
