// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/loads.h"
#include "solver/constraints/constraint_list.h"

#include <array>
#include <cstdint>
#include <span>

namespace iota::ingredient {

/// visit(node, force): the forces of a row of the solver on its nodes in the last step, as in `Assembly::add_rows`:
/// minus its multipliers times its gradients, in the mid-point rule their means over the step. `start` and `end` have
/// the places of the nodes.
template <class C, class Visit>
void for_each_row_force(const C& row, const double* multipliers, bool midpoint, const Vec3* start, const Vec3* end,
                        Visit visit) {
  const solver::Gradients<C> at_end(row, end, 1);
  const solver::MeanGradients<C> means(row, start, 0, at_end);
  for (int i = 0; i < row.node_count(); ++i) {
    Vec3 directions[C::rows], mean[C::rows], force;
    at_end.of_node(i, directions);
    if (midpoint) means.of_node(i, directions, mean);
    for (int r = 0; r < C::rows; ++r) force -= multipliers[r] * (midpoint ? mean[r] : directions[r]);
    visit(row.nodes[i], force);
  }
}

/// The same for a row whose nodes are numbered as some particles are: visit(particle, force).
template <class C, class Visit>
void for_each_row_force(const LastStep& step, const C& row, const double* multipliers,
                        std::span<const std::uint32_t> particles, Visit visit) {
  std::array<Vec3, C::max_nodes> start, end;
  for (std::size_t i = 0; i < particles.size(); ++i)
    start[i] = step.start(particles[i]), end[i] = step.end(particles[i]);
  for_each_row_force(row, multipliers, step.stage.midpoint, start.data(), end.data(),
                     [&](std::uint32_t node, const Vec3& force) { visit(particles[node], force); });
}

}  // namespace iota::ingredient
