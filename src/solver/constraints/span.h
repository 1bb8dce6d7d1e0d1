// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/arms.h"

namespace iota::solver {

/// The distance of two points: limits, motors, friction and springs along it, and the pieces of a rope over several points.
///   constraint  g(x) = |d| - target(fraction)   (m);   arm 0: d
///   gradient    dg/dd = n = d / |d|;   Hessian (I - n n') / |d|
/// The multiplier is the tension, N. If the points coincide the direction is undefined, and no force acts.
struct SpanConstraint : ArmConstraint<SpanConstraint, 1, 1> {
  double target_start = 0, target = 0;  ///< m; it moves linearly during the step
  double reference = 1;                 ///< reference length of violations, m

  double reference_length() const { return reference; }
  bool is_moving() const { return target != target_start || Arms::is_moving(); }
  void calc_value(const Vec3* e, double fraction, double* g) const {
    g[0] = norm(e[0]) - (target_start + fraction * (target - target_start));
  }
  void calc_gradient(const Vec3* e, Vec3 (*d)[1]) const {
    const double length = norm(e[0]);
    d[0][0] = length > 0 ? (1 / length) * e[0] : Vec3{};
  }
  /// Clamped: a span in compression is left out.
  void calc_hessian(const Vec3* e, const double* lambda, bool clamp, Mat3 (*h)[1]) const {
    const double length = norm(e[0]);
    h[0][0] = {};
    if (!(length > 0) || (clamp && lambda[0] < 0)) return;
    const Vec3 n = (1 / length) * e[0];
    h[0][0] = lambda[0] / length * (Mat3::diagonal(1) + -1.0 * Mat3::outer(n, n));
  }
  /// (d0 + d1) / (|d0| + |d1|): times d1 - d0 it is the change of the length.
  void mean_gradients(const Vec3* x0, double start, const Vec3* x1, double end, Vec3* out) const {
    const Vec3 d0 = arm(0, x0, start), d1 = arm(0, x1, end);
    const double lengths = norm(d0) + norm(d1);
    const Vec3 mean = lengths > 0 ? (1 / lengths) * (d0 + d1) : Vec3{};
    for (std::uint32_t i = 0; i < count; ++i) out[i] = weights[0][i] * mean;
  }
};

}  // namespace iota::solver
