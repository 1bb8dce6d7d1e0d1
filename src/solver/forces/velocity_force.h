// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "laws/velocity_part.h"
#include "solver/forces/force_arm.h"

namespace iota::solver {

/// The part of a held force that is linear in the velocity of a place, as laws::VelocityPart says. Its v0 is the rate of
/// the arm at the start of the (sub-)step, which positions do not tell: `begin` notes it. v1 = (e1 - e0)/h, or by the mid-point
/// rule 2 (e1 - e0)/h - v0.
struct VelocityForce {
  static constexpr bool is_external = true;
  ForceArm arm;
  laws::VelocityPart part;
  Vec3 start;  ///< v0, m/s

  void begin(const Vec3* velocities, double h) { begin(arm.rate(velocities), h); }
  void begin(const Vec3& rate, double h) { start = rate, part.begin(h); }

  static constexpr bool keeps_angular_momentum() { return false; }
  double energy(const Vec3&) const { return 0; }
  Vec3 force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    return s.instant ? part.at_an_instant(e1 - e0) : part.force(start, at_end(e0, e1, s));
  }
  /// The energy that the drag alone takes, J. The turning part does none by the mean velocity; by the end-point rule, which moves a place by
  /// the velocity at the end, it is that of the scheme's own error.
  double work(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const Vec3 f = force(e0, e1, s);
    return dot(s.instant ? f : f - part.turn(0.5 * (start + at_end(e0, e1, s))), e1 - e0);
  }
  double dissipation(const Vec3&, const Vec3&, const ForceStage&) const { return 0; }  // all of its work is external
  Mat3 stiffness_matrix(const Vec3&, const Vec3&, const ForceStage& s) const {
    return (s.midpoint ? -2 : -1) / s.h * part.rate();
  }

 private:
  Vec3 at_end(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const Vec3 mean = (1 / s.h) * (e1 - e0);
    return s.midpoint ? 2 * mean - start : mean;
  }
};

}  // namespace iota::solver
