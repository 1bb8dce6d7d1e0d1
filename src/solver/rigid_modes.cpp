// SPDX-License-Identifier: Apache-2.0
#include "solver/rigid_modes.h"

#include "solver/holds.h"
#include "solver/pieces.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

RigidMode RigidModes::beside(RigidMode mode) const {
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t k = 0; k < count; ++k) mode.add(-mode.along(modes[k]), modes[k]);
  return mode;
}

RigidMode RigidModes::another() const {
  constexpr RigidMode units[]{{{1, 0, 0}, {}}, {{0, 1, 0}, {}}, {{0, 0, 1}, {}},
                              {{}, {1, 0, 0}}, {{}, {0, 1, 0}}, {{}, {0, 0, 1}}};
  RigidMode best;
  for (const RigidMode& unit : units)
    if (const RigidMode own = beside(unit); own.along(own) > best.along(best)) best = own;
  return best;
}

void RigidModes::add(const RigidMode& mode, double size) {
  if (are_all()) return;
  RigidMode own = beside(mode);
  const double square = own.along(own);
  if (!(square > independent * size)) return;
  const double scale = 1 / std::sqrt(square);
  modes[count++] = {scale * own.velocity, scale * own.turning};
}

std::optional<Axle> RigidModes::axle() const {
  constexpr double little = 1e-9;
  if (count + 1 != modes.size()) return {};
  const RigidMode free = another();
  const double turning = norm(free.turning);
  if (!(std::abs(dot(free.velocity, free.turning)) <= little * turning * turning)) return {};  // a screw
  if (!(norm(free.velocity) * little < turning)) return {};
  return Axle{center + (length / (turning * turning)) * cross(free.turning, free.velocity),
              (1 / turning) * free.turning};
}

void add_noticed_modes(const Problem& problem, std::span<const std::uint32_t> part_of, std::span<RigidModes> noticed,
                       Noticed by) {
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
    if (by == Noticed::by_joints && is_of_contact<C>) return;
    const C& c = pool.items[i];
    const auto nodes = pool.nodes_of(c);
    const auto moves = [&](std::uint32_t node) { return part_of[node] != Pieces::none; };
    const auto first = std::find_if(nodes.begin(), nodes.end(), moves);
    if (first == nodes.end() || noticed[part_of[*first]].are_all()) return;
    if (c.is_internal() && !holds_direction(c) && std::all_of(nodes.begin(), nodes.end(), moves)) return;
    RigidModes& part = noticed[part_of[*first]];
    const Gradients<C> gradients(c, problem.position.data(), 1);
    RigidMode modes[C::rows];
    double sizes[C::rows] = {};
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (!moves(nodes[k])) continue;
      Vec3 rows[C::rows];
      gradients.of_node(static_cast<int>(k), rows);
      const Vec3 arm = (1 / part.length) * (problem.position[nodes[k]] - part.center);
      for (std::size_t r = 0; r < C::rows; ++r) {
        modes[r].velocity += rows[r], modes[r].turning += cross(arm, rows[r]);
        sizes[r] += dot(rows[r], rows[r]) * (1 + dot(arm, arm));
      }
    }
    for (std::size_t r = 0; r < C::rows; ++r) part.add(modes[r], sizes[r]);
  });
}

}  // namespace iota::solver
