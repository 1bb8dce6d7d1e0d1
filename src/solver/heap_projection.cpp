// SPDX-License-Identifier: Apache-2.0
// Projections of a heap after edits: its steps are left to sweeps, and a projection on all its contacts took up to a thousand steps.
#include "base/sort_unique.h"
#include "solver/heap.h"
#include "solver/newton.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace iota::solver {

// In the mass norm, by the equations of these lengths alone. Sweeps keep a body as it is, so that one of which an edit has moved
// a point would keep a wrong shape.
void Heap::restore_shape(const Problem& problem, std::uint32_t i, std::span<const Length> lengths) {
  Body& body = found_.all[i];
  Problem part;
  part.add_nodes(body.count);
  for (std::uint32_t k = 0; k < body.count; ++k)
    part.position[k] = body.arms[k], part.mass[k] = body.shares[k] * problem.mass[body.nodes[k]];
  for (const HeapBodies::Coupling& coupling : found_.couplings) {
    const auto& c = problem.mass_couplings[coupling.item];
    // Without shared points one of round-off may reach another body.
    if (coupling.body == i && found_.have(i, c.b))
      part.couple_masses(found_.place_of(i, c.a), found_.place_of(i, c.b), coupling.share * c.mass);
  }
  for (const Length& length : lengths) {
    DistanceConstraint c = problem.items_of<DistanceConstraint>()[length.item];
    for (std::uint32_t& node : c.nodes) node = found_.place_of(i, node);
    part.add(c, {});
  }
  Newton newton;
  newton.compile(part);
  Stage stage = Stage::projection();
  stage.fraction = 0, stage.max_iterations = 20;
  std::ranges::fill(newton.displacement(), Vec3{});
  if (!newton.solve(part, stage).converged) return;
  std::copy_n(newton.solution().begin(), body.count, body.arms.begin());
  const Vec3 angular_momentum = body.inertia * motions_[i].spin;
  body.inertia = {};
  for (std::uint32_t k = 0; k < body.count; ++k) body.inertia += point_inertia(part.mass[k], body.arms[k]);
  for (const auto& c : part.mass_couplings)
    body.inertia += coupled_inertia(c.mass, body.arms[c.a], body.arms[c.b]),
        body.inertia += coupled_inertia(c.mass, body.arms[c.b], body.arms[c.a]);
  invert_inertia(body, motions_[i]);
  motions_[i].spin = motions_[i].by_inertia * angular_momentum;
}

// Points that were joined, or moved one by one, are not where the lengths of their bodies want them.
void Heap::restore_shapes(const Problem& problem) {
  constexpr double exact = 1e-11;  // of a length
  if (!problem.has_used<DistanceConstraint>()) return;
  const auto& pool = problem.pool_of<DistanceConstraint>();
  const auto for_each_length = [&](auto visit) {
    for (std::uint32_t k = 0; k < pool.items.size(); ++k)
      if (!pool.has_laws() || *pool.law(k) == RowLaw{}) visit(k, found_.with(pool.items[k].nodes));
  };
  std::vector<std::uint32_t> misshapen;
  for_each_length([&](std::uint32_t k, std::uint32_t body) {
    double g = 0;
    pool.value(k, problem.position.data(), 0, &g);
    if (!(std::abs(g) <= exact * pool.items[k].reference_length()) && motions_[body].by_mass > 0)
      misshapen.push_back(body);
  });
  if (misshapen.empty()) return;
  sort_unique(misshapen);
  std::vector<Length> lengths;
  for_each_length([&](std::uint32_t k, std::uint32_t body) {
    if (std::ranges::binary_search(misshapen, body)) lengths.push_back({body, k});
  });
  std::ranges::stable_sort(lengths, {}, &Length::body);
  for (const std::uint32_t body : misshapen)
    restore_shape(problem, body, std::ranges::equal_range(lengths, body, {}, &Length::body));
}

bool Heap::project(Problem& problem, const Projection& projection) {
  load_bodies(problem, 0);
  if (projection.positions) restore_shapes(problem);
  for (std::uint32_t node = 0; node < projection.impulses.size(); ++node) {
    const std::uint32_t i = found_.owner[node];
    const Vec3& impulse = projection.impulses[node];
    motions_[i].velocity += motions_[i].by_mass * impulse;
    motions_[i].spin += motions_[i].by_inertia * cross(problem.position[node] - found_.all[i].center, impulse);
  }
  const bool has_targets = projection.h > 0;
  const double time = has_targets ? projection.h : 1;
  ties_.begin(problem, found_, time);
  const auto project_ties = [&](bool positions) {
    return ties_.project(problem, found_, motions_, time, 0, has_targets ? 1 : 0, positions);
  };
  const bool is_met = project_ties(projection.positions);
  if (!is_met) (void)project_ties(false);
  if (has_targets && !ties_.are_none()) {
    // A body that a joint drives rests on others: without these a box that is pulled at its top turned, and that was work.
    constexpr int rounds = 24;
    points_.load(problem, found_, motions_, 0, 1 / time);
    for (int k = 0; k < rounds; ++k) points_.sweep(motions_, {}, time), ties_.close_rates(motions_);
  }
  if (projection.positions && is_met) store_positions(problem);
  store_velocities(problem);
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>()) {
    if (!c.is_nail() || !found_.all[found_.owner[c.nodes[0]]].is_driven) continue;
    if (projection.positions) problem.position[c.nodes[0]] = c.target_start;
    problem.velocity[c.nodes[0]] = has_targets ? (1 / time) * (c.target - c.target_start) : Vec3{};
  }
  return is_met;
}

}  // namespace iota::solver
