// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "expression/functions.h"
#include "math/mat3.h"

#include <cmath>

namespace iota::laws {

/// The part K v of a force that is linear in the velocity v of a place, in a step of h seconds from v0 to v1:
///   F = a x (v0 + v1)/2 + S ((1 - theta) v0 + theta v1),  K = [a]x + S
/// The antisymmetric part turns v and does no work. theta(S h/m) = 1/y - 1/(exp(y) - 1), of each eigenvalue y of S h/m, makes
/// the step of a free particle of mass m exact under a constant force: a drag of any size never reverses a motion, and its
/// terminal velocity is right. (The Bernoulli function of Scharfetter and Gummel 1969.) Second order, as theta(0) = 1/2.
struct VelocityPart {
  Vec3 turning;      ///< a, N s/m
  Mat3 drag;         ///< S, symmetric; a drag is negative, N s/m
  double mass = 1;   ///< m, kg
  Mat3 drag_at_end;  ///< S theta, of a step
  bool turns = false;

  VelocityPart() = default;
  VelocityPart(const Mat3& rate, double mass_of_place) : mass(mass_of_place) {
    const auto& k = rate.m;
    turning = 0.5 * Vec3{k[2][1] - k[1][2], k[0][2] - k[2][0], k[1][0] - k[0][1]};
    drag = 0.5 * (rate + rate.transposed());
    turns = turning != Vec3{};
  }

  /// Before a step of h seconds.
  void begin(double h) { drag_at_end = weighted_by_theta(drag, h / mass); }

  Vec3 force(const Vec3& v0, const Vec3& v1) const {
    return turn(0.5 * (v0 + v1)) + drag * v0 + drag_at_end * (v1 - v0);
  }
  Vec3 turn(const Vec3& v) const { return cross(turning, v); }
  Vec3 at_an_instant(const Vec3& v) const { return turn(v) + drag * v; }
  /// Derivative of the force by v1.
  Mat3 rate() const { return 0.5 * Mat3::cross_matrix(turning) + drag_at_end; }

  static double theta(double y) {
    if (std::abs(y) < 1e-2) return 0.5 - y / 12 + y * y * y / 720;
    return 1 / y - 1 / (expression::exp(y) - 1);
  }
  static Mat3 weighted_by_theta(const Mat3& s, double time_by_mass) {
    const auto weighted = [&](double value) {
      return value == 0
                 ? 0
                 : value * theta(std::isfinite(time_by_mass) ? value * time_by_mass : std::copysign(1e300, value));
    };
    if (s.m[0][1] == 0 && s.m[0][2] == 0 && s.m[1][2] == 0) {
      const bool is_alike = s.m[0][0] == s.m[1][1] && s.m[0][0] == s.m[2][2];
      Mat3 out = Mat3::diagonal(weighted(s.m[0][0]));
      if (!is_alike) out.m[1][1] = weighted(s.m[1][1]), out.m[2][2] = weighted(s.m[2][2]);
      return out;
    }
    const SymmetricEigen eigen = symmetric_eigen(s);
    Mat3 out;
    for (int i = 0; i < 3; ++i) out += weighted(eigen.values[i]) * Mat3::outer(eigen.axes[i], eigen.axes[i]);
    return out;
  }
};

}  // namespace iota::laws
