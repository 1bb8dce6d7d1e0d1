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
  /// Second derivatives by the arms, times lambda and the identity.
  struct Curvature {
    double aa = 0, ab = 0, bb = 0;
  };
  /// Clamped: of lambda (a_i b_j + b_i a_j) the part lambda/2 (a_i +- b_i)(a_j +- b_j), arms scaled to equal size.
  Curvature curvature_of_arms(double lambda, bool clamp) const {
    const double l = lambda / scale;
    if (!clamp) return {.ab = l};
    double aa = 0, bb = 0;
    for (std::uint32_t i = 0; i < count; ++i) aa += weights[0][i] * weights[0][i], bb += weights[1][i] * weights[1][i];
    const double ratio = aa > 0 && bb > 0 ? std::sqrt(bb / aa) : 1;
    return {std::abs(l) / 2 * ratio, l / 2, std::abs(l) / 2 / ratio};
  }
  /// The block of the Hessian for nodes i and j is this times the identity.
  double curvature_between(const Curvature& c, std::uint32_t i, std::uint32_t j) const {
    const auto& [a, b] = weights;
    return a[i] * a[j] * c.aa + a[i] * b[j] * c.ab + b[i] * a[j] * c.ab + b[i] * b[j] * c.bb;
  }
  void calc_hessian(const Vec3*, const double* lambda, bool clamp, Mat3 (*h)[2]) const {
    const Curvature c = curvature_of_arms(lambda[0], clamp);
    h[0][0] = Mat3::diagonal(c.aa), h[0][1] = Mat3::diagonal(c.ab), h[1][1] = Mat3::diagonal(c.bb);
  }
};

}  // namespace iota::solver
