// SPDX-License-Identifier: Apache-2.0
// An island that follows a local change: cuts and hinges, grips, closings, nails, damping.
#include "island/island.h"

#include "solver/integrator.h"

#include <algorithm>

namespace iota::island {

using model::Model;
using model::none;

namespace {

/// The bodies of some articulates (sorted) at some nodes, sorted, and those nodes that have no other bodies.
struct Around {
  std::vector<std::uint32_t> bodies, empty_nodes;

  Around(const Model& model, std::span<const std::uint32_t> articulates, const ingredient::IslandNodes& nodes,
         std::span<const std::uint32_t> changed) {
    for (const std::uint32_t node : changed) {
      bool is_needed = false;
      const auto take = [&](std::uint32_t p) {
        const std::uint32_t body = model.particles[p].body;
        if (!std::binary_search(articulates.begin(), articulates.end(), model.bodies[body].articulate)) return;
        if (model.bodies[body].kind == BodyKind::inactive) return;
        bodies.push_back(body);
        is_needed = is_needed || model.is_unknown(model.particles[p]);
      };
      if (model.rings.is_alive(nodes.rings[node])) model.for_each_in_ring(nodes.rings[node], take);
      if (!is_needed) empty_nodes.push_back(node);
    }
    ingredient::sort_unique(bodies);
  }
};

}  // namespace

bool Island::follow(Model& model, std::span<const std::uint32_t> articulates, const Model::LocalChange& change,
                    std::vector<std::uint32_t>& node_of_ring, MovedRings& moved) {
  constexpr std::size_t part = 8;      // share of the nodes: if more of them change, a new assembly is as fast
  if (idle_ || solver_) return false;  // another solver needs unknowns without gaps
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) node_of_ring[nodes_.rings[node]] = node;
  const std::vector<std::uint32_t> changed = find_changed_nodes(model, change, node_of_ring);
  const bool are_few = changed.size() * part <= nodes_.size();
  if (are_few) {
    const Around around(model, articulates, nodes_, changed);
    nodes_.find_carried_again(model, around.bodies, node_of_ring);
    problem_.open(changed);
    const ingredient::IslandMap map(model, nodes_, around.bodies, node_of_ring);
    for_each_ingredient([&](auto& i) { i.leave(map), i.build(map, problem_); });
    for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
    remove_nodes(around.empty_nodes);
    integrator_->follow(problem_);
    if (!change.pulled.empty() && !renew_pulls(model, node_of_ring)) return false;
    carry_along(model, moved);
  } else {
    for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
  }
  return are_few;
}

bool Island::renew_pulls(const Model& model, std::vector<std::uint32_t>& node_of_ring) {
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) node_of_ring[nodes_.rings[node]] = node;
  const ingredient::IslandMap map(model, nodes_, {}, node_of_ring);
  for_each_ingredient([&](auto& i) { i.renew_pulls(map, problem_); });
  for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
  return integrator_->place_forces(problem_);
}

// The nodes of the rings that changed and of all particles of the bodies that changed. A particle without a node gets one,
// beside that of the ring from which its own was split or of another particle of the body.
std::vector<std::uint32_t> Island::find_changed_nodes(const Model& model, const Model::LocalChange& change,
                                                      std::vector<std::uint32_t>& node_of_ring) {
  std::vector<std::uint32_t> changed;
  for (const auto& [ring, split_from] : change.rings)
    if (node_of_ring[ring] != none) changed.push_back(node_of_ring[ring]);
  for (const std::uint32_t body : change.bodies) {
    if (model.bodies[body].kind == BodyKind::inactive) continue;
    std::uint32_t beside = 0;
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (const std::uint32_t node = node_of_ring[model.particles[p].ring]; node != none) beside = node;
    });
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (!model.is_unknown(model.particles[p])) return;
      const std::uint32_t ring = model.particles[p].ring;
      if (node_of_ring[ring] == none) {
        for (const auto& [other, split_from] : change.rings)
          if (other == ring && split_from != none && node_of_ring[split_from] != none)
            beside = node_of_ring[split_from];
        node_of_ring[ring] = problem_.add_node_beside(beside);
        nodes_.rings.push_back(ring), nodes_.pinned.push_back(0);
      }
      changed.push_back(node_of_ring[ring]);
    });
  }
  ingredient::sort_unique(changed);
  for (const std::uint32_t node : changed) {
    const std::uint32_t ring = nodes_.rings[node];
    nodes_.pinned[node] = model.rings.is_alive(ring) && model.is_pinned(ring);
  }
  return changed;
}

// The last nodes take the numbers of removed ones, here and, when it follows, in the problem.
void Island::remove_nodes(std::vector<std::uint32_t> nodes) {
  std::sort(nodes.begin(), nodes.end(), std::greater<>());
  for (const std::uint32_t node : nodes) problem_.mark_for_removal(node), nodes_.remove(node);
}

}  // namespace iota::island
