// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/arms.h"
#include "solver/constraints/cone.h"

#include <algorithm>

namespace iota::solver {

/// A place of a body against a plane of another body or of the world, or two round things, with Coulomb friction.
///   arms        0: center of what touches - origin of the plane;  1: point that touches - the other body's point there;
///               2: normal, towards the first body;  3, 4: tangents
///   constraint  g_0 = normal . arm 0 - radius,  of round things (|d|^2 - radius^2) / (2 radius),  d arm 0 across `axis`
///               g_k = tangent_k . arm 1,  k = 1, 2   (m)
///   cone        N = -lambda_0 >= 0,  |(lambda_1, lambda_2)| <= mu N   (N)
///     open      all multipliers are zero, g_0 >= 0
///     sticks    g_0 = c_n lambda_0,  s_k = c_t lambda_k,  s_k the slip since it began to stick
///     slips     (lambda_1, lambda_2) = mu N z / |z|,  z = lambda + s / k the trial force, k its natural compliance
/// The center and the point differ for what is round: the ball's center keeps its height while the point turns under it.
/// All rows are quadratic in the points, so that the mid-point rule counts the work of friction exactly.
/// Newton's matrix has the column of mu N, and the curvature of the circle |z|: Alart and Curnier, A mixed formulation for
/// frictional contact problems, 1991. c_n makes the forces of a box on four corners unique, c_t keeps Newton's method from
/// cycling between them. The solver measures the slip from the start of the (sub-)step less the strain c_t lambda with which
/// that began, so that a contact that sticks does not creep.
struct ContactConstraint : ArmConstraint<ContactConstraint, 3, 5> {
  double radius = 0;                             ///< m
  double friction = 0;                           ///< mu
  double normal_compliance = 0, compliance = 0;  ///< c_n, c_t, m/N
  double softening = 1;                          ///< of c_n, while a solution is searched
  double reference = 1;
  bool is_round = false;  ///< the radius is that of both together, above zero
  Vec3 axis;              ///< of round things: a unit vector along which they may slide, or zero

  /// Arms 2 to 4, which do not turn with a body.
  void set_directions(const std::array<Vec3, 3>& of) {
    for (int k = 0; k < 3; ++k) set_constant(2 + k, of[static_cast<std::size_t>(k)]);
  }

  double reference_length() const { return reference; }
  Vec3 across(const Vec3& d) const { return d - dot(axis, d) * axis; }
  void calc_value(const Vec3* e, double /*fraction*/, double* g) const {
    g[0] = is_round ? (dot(across(e[0]), e[0]) / radius - radius) / 2 : dot(e[2], e[0]) - radius;
    g[1] = dot(e[3], e[1]), g[2] = dot(e[4], e[1]);
  }
  /// The functions of ArmConstraint, without its zeros: they are a quarter of the time of a heap.
  void gradients(const Vec3* x, double /*fraction*/, Vec3* out) const {
    const Vec3 d = arm(0, x, 1), slip = arm(1, x, 1), normal = arm(2, x, 1), first = arm(3, x, 1), second = arm(4, x, 1);
    const Vec3 outward = is_round ? (1 / radius) * across(d) : normal;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto w = [&](std::size_t arm) { return weights[arm][i]; };
      out[3 * i] = is_round ? w(0) * outward : w(0) * outward + w(2) * d;
      out[3 * i + 1] = w(1) * first + w(3) * slip;
      out[3 * i + 2] = w(1) * second + w(4) * slip;
    }
  }
  void curvature(const Vec3* /*x*/, double /*fraction*/, const double* lambda, bool clamp, Mat3* blocks) const {
    const double pull = is_round ? (clamp ? std::max(0.0, lambda[0]) : lambda[0]) / radius : 0;
    const double of_normal = is_round || clamp ? 0 : lambda[0], of_first = clamp ? 0 : lambda[1], of_second = clamp ? 0 : lambda[2];
    const Mat3 along = pull != 0 ? Mat3::outer(axis, axis) : Mat3{};
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t j = i; j < count; ++j, ++blocks) {
        const auto mixed = [&](std::size_t a, std::size_t b) {
          return weights[a][i] * weights[b][j] + weights[b][i] * weights[a][j];
        };
        const double both = pull * weights[0][i] * weights[0][j];
        *blocks = Mat3::diagonal(both + of_normal * mixed(0, 2) + of_first * mixed(1, 3) + of_second * mixed(1, 4));
        if (both != 0) *blocks += -both * along;
      }
  }

  static constexpr bool is_tangent(int r) { return r > 0; }
  static constexpr bool is_one_sided(int r) { return r == 0; }
  double compliance_of(int r) const { return r == 0 ? softening * normal_compliance : compliance; }
  /// The friction that the normal force allows, N.
  double largest_friction(const double* multipliers) const { return friction * std::max(0.0, -multipliers[0]); }

  /// The state in which multipliers would be a solution.
  ConeState state_of(const double* multipliers) const;
  /// Another state, if the multipliers and values do not fit the present one. Tangential values are slips; `natural`:
  /// compliance of each row at the points, m/N; gaps up to `tolerance` change nothing.
  ConeState switch_state(ConeState now, const double* multipliers, const double* g, const double* natural,
                         double tolerance) const;
  /// A state with direction 0 slips without friction.
  ConeEquations equations(ConeState, const double* multipliers, const double* g, const double* natural) const;
};

}  // namespace iota::solver
