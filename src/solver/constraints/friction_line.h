// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/cone.h"
#include "solver/constraints/place.h"

#include <cmath>

namespace iota::solver {

/// A point on a straight line fixed in a body or in the world, with Coulomb friction by the reaction of the line.
///   constraint  g_k = xi_{k+1}, k = 0, 1: across the line;   g_2 = xi_0 along it   (m)
///   cone        |lambda_2| <= mu |N|,  N = (lambda_0, lambda_1): the reaction, N
///     sticks    g_2 as at the start of the (sub-)step
///     slips     lambda_2 = +-mu |N|, against the motion
/// The line is axis 0 of the frame. All rows are quadratic in the points, so that the mid-point rule counts the work of
/// friction exactly. A line that may pull and push has no open state.
struct FrictionLineConstraint : PlaceConstraint<FrictionLineConstraint, 3> {
  double friction = 0;  ///< mu
  double reference = 1;
  /// The compliance of rows across the line, in parts of their natural one. Guides that hold the same would press against each other
  /// by the round-off of places, and so by friction hold what should fall.
  static constexpr double softness_across = 1e-8;

  double reference_length() const { return reference; }
  void calc_place_value(const Vec3& xi, double /*fraction*/, double* g) const { g[0] = xi.y, g[1] = xi.z, g[2] = xi.x; }
  void calc_place_gradient(const Vec3&, Vec3* d) const { d[0] = {0, 1, 0}, d[1] = {0, 0, 1}, d[2] = {1, 0, 0}; }
  Mat3 calc_place_hessian(const Vec3&, const double*) const { return {}; }

  /// The friction that the reaction allows, N.
  double largest_friction(const double* multipliers) const {
    return friction * std::hypot(multipliers[0], multipliers[1]);
  }

  /// Row r is along a tangent: it keeps its value of the start of the (sub-)step while it sticks.
  static constexpr bool is_tangent(int r) { return r == 2; }
  static constexpr bool is_one_sided(int) { return false; }
  static double compliance_of(int) { return 0; }
  /// The state in which multipliers would be a solution.
  ConeState state_of(const double* multipliers) const {
    constexpr double at_edge = 1 - 1e-6;
    const double size = std::abs(multipliers[2]);
    if (size == 0 || size < at_edge * largest_friction(multipliers)) return {};
    return {ConeState::Mode::slips, multipliers[2] > 0 ? 1 : -1};
  }
  /// Another state, if the multipliers and values do not fit the present one. g[2] is measured from the start of the
  /// (sub-)step; `natural`: compliance of each row at the points, m/N; gaps up to `tolerance` change nothing.
  ConeState switch_state(ConeState now, const double* multipliers, const double* g, const double* natural,
                         double tolerance) const {
    const double softness = natural[2];
    if (now.slips()) return now.direction * g[2] < -tolerance ? ConeState{} : now;
    const double edge = largest_friction(multipliers);
    if (g[2] + softness * (multipliers[2] - edge) > tolerance) return {ConeState::Mode::slips, 1};
    if (g[2] + softness * (multipliers[2] + edge) < -tolerance) return {ConeState::Mode::slips, -1};
    return now;
  }
  ConeEquations equations(ConeState state, const double* multipliers, const double* g, const double* natural) const {
    const double softness = natural[2];
    ConeEquations e{.value = {g[0], g[1], g[2]}, .by_value = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    for (std::size_t k = 0; k < 2; ++k) {
      const double give = softness_across * natural[k];
      e.value[k] -= give * multipliers[k], e.by_multiplier[k][k] = -give;
    }
    if (!state.slips()) return e;
    const double size = std::hypot(multipliers[0], multipliers[1]), edge = state.direction * friction;
    e.value[2] = softness * (edge * size - multipliers[2]);
    e.by_value[2] = {};
    for (std::size_t k = 0; k < 2 && size > 0; ++k) e.by_multiplier[2][k] = softness * edge * multipliers[k] / size;
    e.by_multiplier[2][2] = -softness;
    return e;
  }
};

}  // namespace iota::solver
