// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/arms.h"

namespace iota::solver {

/// The product of two arms is constant: perpendicular axes (revolute, universal, weld, orientation), a point in a
/// plane of a body (prismatic, cylindrical), a distance of two points of bodies (rod, rope: both arms equal).
/// constraint g(x) = (a . b - c) / s, a = sum a_i x_i + u, b = sum b_i x_i + v gradient dg/dx_i = (a_i b + b_i a) /
/// s
///   Hessian     d2g/dx_i dx_j = (a_i b_j + b_i a_j) / s I: constant, so that the mean of two gradients is a discrete gradient
/// c and s in m^2 and m if a and b are lengths, and the multiplier is then a force in N; for a distance L
/// c = L^2, s = 2 L, and the multiplier is the tension. Source: Garcia de Jalon, Twenty-five years of natural coordinates, 2007.
struct BilinearConstraint : ArmConstraint<BilinearConstraint, 1, 2> {
  double product = 0;    ///< c
  double scale = 1;      ///< s
  double reference = 1;  ///< reference of violations, in the unit of g

  double reference_length() const { return reference; }
  void calc_value(const Vec3* e, double /*fraction*/, double* g) const { g[0] = (dot(e[0], e[1]) - product) / scale; }
  void calc_gradient(const Vec3* e, Vec3 (*d)[2]) const { d[0][0] = (1 / scale) * e[1], d[0][1] = (1 / scale) * e[0]; }
  /// Clamped: of lambda (a_i b_j + b_i a_j) the part lambda/2 (a_i +- b_i)(a_j +- b_j), arms scaled to equal size.
  void calc_hessian(const Vec3*, const double* lambda, bool clamp, Mat3 (*h)[2]) const {
    const double l = lambda[0] / scale;
    h[0][1] = Mat3::diagonal(clamp ? l / 2 : l);
    if (!clamp) {
      h[0][0] = h[1][1] = {};
      return;
    }
    double aa = 0, bb = 0;
    for (std::uint32_t i = 0; i < count; ++i) aa += weights[0][i] * weights[0][i], bb += weights[1][i] * weights[1][i];
    const double ratio = aa > 0 && bb > 0 ? std::sqrt(bb / aa) : 1;
    h[0][0] = Mat3::diagonal(std::abs(l) / 2 * ratio);
    h[1][1] = Mat3::diagonal(std::abs(l) / 2 / ratio);
  }
};

}  // namespace iota::solver
