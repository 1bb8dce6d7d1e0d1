// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"
#include "solver/stage.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

/// The equation of a free row: value - softness * lambda = 0.
struct RowEquation {
  double value, softness;
};

/// The equation of a one-sided spring in a step of the mid-point rule that begins or ends slack. Only the stretched part of
/// the way takes work, with the stretch e:
///   lambda (g1 - g0) = (e1 - e0) (k (e0 + e1)/2 + c (e1 - e0)/h)
/// Divided by d lambda/d g1, since the matrix has the gradient of g1. With g0 instead of e0 a rope of 5e-6 m/N, whose dashpot
/// acted while it was slack by 0.1 m, made 1000 J. stiffness: k/2, damping: c/h.
inline RowEquation equation_at_slack(double g0, double e0, double g, double stiffness, double damping) {
  constexpr double flattest = 1e-3;  // of the slack: where it begins, lambda has no slope
  if (e0 == 0) {
    const double sign = g0 < 0 ? 1 : -1, slack = std::abs(g0);
    const double stretch = std::max(sign * g, flattest * slack), way = stretch + slack;
    const double lambda = (stiffness + damping) * stretch * stretch / way;
    const double slope = (stiffness + damping) * stretch * (stretch + 2 * slack) / (way * way);
    return {g + sign * (lambda / slope - stretch), 1 / slope};
  }
  const double part = e0 / (e0 - g);
  return {e0 / part, 1 / ((stiffness - damping) * part * part)};
}

/// The equation of row r of item i, where its value is g. In the mid-point scheme a spring uses its mean stretch, so that
/// its energy is kept exactly.
template <class C>
RowEquation equation_of(const ConstraintPool<C>& pool, std::size_t i, int r, double g, const Stage& stage) {
  const RowLaw& law = pool.law(i)[r];
  const double start = pool.states.start(i * C::rows + static_cast<std::size_t>(r));
  if (law.is_rate) g -= start + law.rate * stage.h;
  // In a projection also a spring is rigid: it obeys its load, see ActiveSet::Springs.
  if (!law.is_compliant() || stage.is_projection())
    return {g, pool.states.yield(i * C::rows + static_cast<std::size_t>(r))};
  const double part = stage.is_mid_point() ? 0.5 : 1;
  const double stiffness = 1 / law.compliance, damping = law.damping / stage.h;
  const double total = part * stiffness + damping;
  const double before = law.is_rate ? 0 : law.stretch(start);
  if (stage.is_mid_point() && !law.is_rate && law.is_one_sided()) {
    const bool becomes_taut = before == 0 && start != 0;
    const bool becomes_slack = before != 0 && law.stretch(g) == 0 && g != 0 && part * stiffness > damping;
    if (becomes_taut || becomes_slack) return equation_at_slack(start, before, g, part * stiffness, damping);
  }
  return {g + ((1 - part) * stiffness - damping) / total * before, 1 / total};
}

/// The way of tangential row r in a (sub-)step in which it sticks, m: the integral of its rate, 0 over a whole step.
template <ConeConstraint C>
double way_of([[maybe_unused]] const C& c, [[maybe_unused]] int r, const Stage& stage) {
  double rates = 0;
  if constexpr (BouncingConstraint<C>) rates = c.rate_of(r, stage.fraction_start) + c.rate_of(r, stage.fraction);
  return 0.5 * stage.h * rates;
}

/// The equations of a cone's rows, where their values are g; `mobilities`: sum |G|^2 / m of each. Positions and impulses, on
/// which finite forces have no effect, have no friction. Soft rows are eliminated before their points, so that in projections they
/// need a softness, too: without it balls that met had 1e-4 rad/s of round-off. It is in the matrix only, and other passes remove
/// what it leaves.
template <ConeConstraint C>
ConeEquations equations_of(const ConstraintPool<C>& pool, std::size_t i, const double* g, const double* mobilities,
                           const Stage& stage) {
  double values[C::rows], natural[C::rows];
  for (int r = 0; r < C::rows; ++r) {
    values[r] = g[r] - (C::is_tangent(r) ? pool.states.start(i * C::rows + static_cast<std::size_t>(r)) : 0);
    if (!stage.is_projection()) values[r] -= way_of(pool.items[i], static_cast<int>(r), stage);
    natural[r] = mobilities[r] / stage.inertia;
  }
  ConeState state = pool.states.cone(i * C::rows);
  if (!stage.is_projection()) return pool.items[i].equations(state, pool.multiplier(i), values, natural);
  state.direction = 0;
  ConeEquations e = pool.items[i].equations(state, pool.multiplier(i), values, natural);
  constexpr double of_reaction = 1e-8;
  for (int r = 0; r < C::rows; ++r)
    if (pool.items[i].compliance_of(r) > 0 && pool.is_equation(i, r))
      e.value[r] = values[r], e.by_multiplier[r][r] = -(C::is_tangent(r) ? stage.softness : of_reaction) * natural[r];
  return e;
}

/// Values, gradients and speeds of a constraint's rows at the positions and velocities of a problem.
template <class C>
struct RowMotion {
  double value[C::rows], speed[C::rows] = {};
  double size[C::rows] = {};  ///< the largest speed that these velocities can cause

  RowMotion(const Problem& problem, const C& c) : gradients_(c, problem.position.data(), 1) {
    c.value(problem.position.data(), 1, value);
    for (int i = 0; i < c.node_count(); ++i) {
      gradients_.of_node(i, rows_[i]);
      const Vec3& v = problem.velocity[c.nodes[i]];
      for (int r = 0; r < C::rows; ++r) speed[r] += dot(rows_[i][r], v), size[r] += norm(rows_[i][r]) * norm(v);
    }
  }
  const Vec3& gradient(int node, int r) const { return rows_[node][r]; }

 private:
  Gradients<C> gradients_;
  Vec3 rows_[C::max_nodes][C::rows];
};

/// The multiplier of a row that is no equation while it moves: a bound, or the force of a spring by its value and speed.
inline double multiplier_in_motion(const RowLaw& law, double at_bound, double value, double speed) {
  return law.is_compliant() ? law.spring_force(value, speed) : law.is_rate ? at_bound : 0;
}

/// Whether all rows of an item are at a bound of zero, so that it has no effect. A contact that a projection has opened keeps the
/// multipliers of the step.
template <class C>
bool is_out_of_play(const ConstraintPool<C>& pool, std::size_t item) {
  if constexpr (ConeConstraint<C>)
    if (pool.states.cone(item * C::rows).mode == ConeState::Mode::open) return true;
  for (int r = 0; r < C::rows; ++r)
    if (pool.is_equation(item, r) || pool.multiplier(item)[r] != 0) return false;
  return true;
}

}  // namespace iota::solver
