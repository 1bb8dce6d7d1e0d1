// SPDX-License-Identifier: Apache-2.0
#include "ingredient/nails.h"

#include <algorithm>

namespace iota::ingredient {

namespace {

using Pool = solver::ConstraintPool<solver::AffineConstraint>;

Vec3 velocity_of(const solver::AffineConstraint& nail, double h) { return (1 / h) * (nail.target - nail.target_start); }

}  // namespace

void Nails::build(const IslandMap& map, Problem& problem) {
  auto& affines = constraints_in<solver::AffineConstraint>(problem);
  first_ = static_cast<std::uint32_t>(affines.size());
  for (std::uint32_t node = 0; node < map.nodes.size(); ++node) {
    if (!map.is_pinned(node)) continue;
    solver::AffineConstraint nail;
    nail.nodes[0] = node, nail.weights[0] = 1, nail.count = 1;
    affines.push_back(nail);
    nodes_.push_back(node);
  }
}

void Nails::load(const Model& model, const IslandNodes& nodes, double h, Problem& problem) {
  auto& affines = std::get<Pool>(problem.constraints);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::uint32_t ring = nodes.rings[nodes_[i]];
    const model::Nail& from = model.nails.at(ring);
    auto& nail = affines.items[first_ + i];
    nail.target = from.position;
    nail.target_start = model.rings[ring].nailed && h > 0 ? from.position_before : nail.target;
    double* const l = affines.multiplier(first_ + i);
    l[0] = from.multiplier.x, l[1] = from.multiplier.y, l[2] = from.multiplier.z;
  }
}

void Nails::store(Model& model, const IslandNodes& nodes, double, const Problem& problem) const {
  const auto& affines = std::get<Pool>(problem.constraints);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    model::Nail& nail = model.nails.at(nodes.rings[nodes_[i]]);
    const double* const l = affines.multiplier(first_ + i);
    nail.multiplier = {l[0], l[1], l[2]};
    nail.position_before = nail.position;
  }
}

void Nails::refresh(Model& model, const IslandNodes& nodes, bool moved) const {
  if (!moved) return;
  for (const std::uint32_t node : nodes_) {
    model::Nail& nail = model.nails.at(nodes.rings[node]);
    nail.position_before = nail.position;
  }
}

// A static body's rings are nailed where the body was put. Nailed where they are at each step, they would creep under
// their load.
void Nails::accept_assigned(Model& model, const IslandNodes& nodes) const {
  constexpr double creep = 1e-7;  // m; a ring that is farther away was moved by the script
  for (const std::uint32_t node : nodes_) {
    const model::Ring& ring = model.rings[nodes.rings[node]];
    model::Nail& nail = model.nails.at(nodes.rings[node]);
    if (!ring.nailed && norm(ring.position - nail.position) > creep)
      nail.position = nail.position_before = ring.position;
  }
}

bool Nails::prescribes_motion(const Model& model, const IslandNodes& nodes) const {
  return std::any_of(nodes_.begin(), nodes_.end(), [&](std::uint32_t node) {
    const model::Ring& ring = model.rings[nodes.rings[node]];
    const model::Nail& nail = model.nails.at(nodes.rings[node]);
    return (ring.nailed && nail.position != nail.position_before) || ring.velocity != Vec3{};
  });
}

double Nails::velocity_jump(const Problem& problem, double h) const {
  const auto& affines = std::get<Pool>(problem.constraints).items;
  double largest = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    largest = std::max(largest, norm(velocity_of(affines[first_ + i], h) - problem.velocity[nodes_[i]]));
  return largest;
}

void Nails::impose_velocities(Problem& problem, double h) const {
  const auto& affines = std::get<Pool>(problem.constraints).items;
  for (std::size_t i = 0; i < nodes_.size(); ++i) problem.velocity[nodes_[i]] = velocity_of(affines[first_ + i], h);
}

void Nails::impose_positions(Problem& problem) const {
  const auto& affines = std::get<Pool>(problem.constraints).items;
  for (std::size_t i = 0; i < nodes_.size(); ++i) problem.position[nodes_[i]] = affines[first_ + i].target;
}

std::string Nails::name_of_row(const Model& model, const IslandNodes& nodes, const solver::RowName& row) const {
  if (row.pool != pool_index<solver::AffineConstraint> || row.item - first_ >= nodes_.size()) return {};
  return "what pins " + nodes.name(model, nodes_[row.item - first_]);
}

void Nails::renumber_node(std::uint32_t from, std::uint32_t to) {
  std::replace(nodes_.begin(), nodes_.end(), from, to);
}

void Nails::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a nail", model.nails, model.rings);
  model.rings.for_each([&](std::uint32_t slot, const model::Ring& r) {
    audit.require(!r.nailed || model.nails.has(slot), "ring ", slot, " is nailed nowhere");
  });
}

double Nails::worst_gap(const Model& model) {
  double worst = 0;
  model.nails.for_each([&](std::uint32_t ring, const model::Nail& nail) {
    if (!model.rings[ring].nailed) return;
    bool moves = false;
    model.for_each_in_ring(
        ring, [&](std::uint32_t p) { moves = moves || is_free(model.bodies[model.particles[p].body].kind); });
    if (!moves) return;
    const double gap = norm(model.rings[ring].position - nail.position_before);
    if (!(gap <= worst)) worst = gap;
  });
  return worst;
}

}  // namespace iota::ingredient
