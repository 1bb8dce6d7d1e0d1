// SPDX-License-Identifier: Apache-2.0
// An island that follows a change: cuts, hinges, ties, closings, nails, damping, and bodies that join or leave it.
#include "island/island.h"

#include "base/sort_unique.h"
#include "solver/integrator.h"

#include <algorithm>

namespace iota::island {

using model::Model;
using model::none;

namespace {

/// The bodies of some articulates (sorted) at some nodes, sorted, and those nodes that have no other bodies.
struct Around {
  std::vector<std::uint32_t> bodies, empty_nodes;

  void find(const Model& model, std::span<const std::uint32_t> articulates, const ingredient::IslandNodes& nodes,
            std::span<const std::uint32_t> changed) {
    bodies.clear(), empty_nodes.clear();
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
    sort_unique(bodies);
  }
};

/// Lists of the change at hand, which keep their room: islands follow one after the other.
struct Lists {
  std::vector<std::uint32_t> changed, leaving;
  Around around;
  std::vector<std::uint32_t> order;
};
thread_local Lists lists_at_hand;

}  // namespace

bool Island::follow(Model& model, std::span<const std::uint32_t> articulates, const Change& change,
                    std::vector<std::uint32_t>& node_of_ring, MovedRings& moved) {
  constexpr std::size_t part = 3;  // share of the nodes: if more of them change, a new assembly is as fast
  if (idle_ || solver_ || !integrator_->can_follow()) return false;  // another solver needs unknowns without gaps
  drop_try();
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) node_of_ring[nodes_.rings[node]] = node;
  nodes_.articulates.assign(articulates.begin(), articulates.end());
  if (!change.left.empty())
    std::erase_if(nodes_.bodies,
                  [&](std::uint32_t body) { return std::binary_search(change.left.begin(), change.left.end(), body); });
  nodes_.bodies.insert(nodes_.bodies.end(), change.joined.begin(), change.joined.end());
  find_first_body();
  auto& [changed, leaving, around, order] = lists_at_hand;
  changed.clear();
  find_changed_nodes(model, change, node_of_ring, changed);
  const bool are_few = changed.size() * part <= nodes_.size();
  if (are_few) {
    around.find(model, articulates, nodes_, changed);
    nodes_.find_carried_again(model, around.bodies, change.left, node_of_ring);
    problem_.open(changed);
    leaving.assign(around.bodies.begin(), around.bodies.end());
    leaving.insert(leaving.end(), change.left.begin(), change.left.end());
    sort_unique(leaving);
    const ingredient::IslandMap before(model, nodes_, leaving, node_of_ring);
    const ingredient::IslandMap map(model, nodes_, around.bodies, node_of_ring);
    for_each_ingredient([&](auto& i) { i.leave(before), i.build(map, problem_); });
    for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
    for (const std::uint32_t node : around.empty_nodes) problem_.mark_for_removal(node);
    nodes_.remove(around.empty_nodes);
    integrator_->follow(problem_);
    idle_ = has_no_free_body(model);
    stride_ = 0, is_frozen_ = false;
    if (!change.local.pulled.empty() && !renew_pulls(model, node_of_ring)) return false;
    carry_along(model, moved);
    look_whether_still(model);
  } else {
    for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
  }
  return are_few;
}

// Rows by themselves have ranks among those of the nodes.
void Island::find_order(std::vector<std::uint32_t>& order) const {
  order.clear();
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    const std::uint32_t rank = integrator_->node_rank(node);
    if (rank >= order.size()) order.resize(rank + 1, none);
    order[rank] = node;
  }
  std::erase(order, none);
}

void Island::append_order(std::vector<std::uint32_t>& rings) const {
  find_order(lists_at_hand.order);
  for (const std::uint32_t node : lists_at_hand.order) rings.push_back(nodes_.rings[node]);
}

bool Island::keeps_order() const {
  return problem_.items_of<solver::ContactConstraint>().empty() && integrator_->is_order_fine();
}

double Island::order_work() const { return integrator_->order_work(); }

bool Island::renew_pulls(const Model& model, std::vector<std::uint32_t>& node_of_ring) {
  drop_try();
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) node_of_ring[nodes_.rings[node]] = node;
  const ingredient::IslandMap map(model, nodes_, {}, node_of_ring);
  for_each_ingredient([&](auto& i) { i.renew_pulls(map, problem_); });
  for (const std::uint32_t ring : nodes_.rings) node_of_ring[ring] = none;
  return integrator_->set_slots_of_forces(problem_);
}

void Island::add_node(const Model& model, std::uint32_t ring, std::uint32_t beside,
                      std::vector<std::uint32_t>& node_of_ring) {
  node_of_ring[ring] = problem_.add_node_beside(beside);
  nodes_.rings.push_back(ring), nodes_.pinned.push_back(model.is_pinned(ring));
}

// The nodes of the rings that changed and of all particles of the bodies that changed, joined or left, also of those that
// are no longer unknowns: without a bond, or outside of a new basis. An unknown without a node gets one: in the order of
// the island that it comes from, beside that of the ring from which its own was split, or beside another particle of the
// body.
void Island::find_changed_nodes(const Model& model, const Change& change, std::vector<std::uint32_t>& node_of_ring,
                                std::vector<std::uint32_t>& changed) {
  const auto is_needed = [&](std::uint32_t ring) {  // its bodies may have left, or it is one of other bodies meanwhile
    bool any = false;
    if (model.rings.is_alive(ring))
      model.for_each_in_ring(ring, [&](std::uint32_t p) {
        any = any || (model.is_unknown(model.particles[p]) && nodes_.has(model, model.particles[p].body));
      });
    return any;
  };
  for (const std::uint32_t ring : change.joined_rings)
    if (node_of_ring[ring] == none && is_needed(ring)) add_node(model, ring, solver::GraphChange::front, node_of_ring);
  for (const auto& [ring, split_from] : change.local.rings)
    if (node_of_ring[ring] != none) changed.push_back(node_of_ring[ring]);
  for (const std::uint32_t body : change.left)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (const std::uint32_t node = node_of_ring[model.particles[p].ring]; node != none) changed.push_back(node);
    });
  for (const std::uint32_t body : change.local.bodies) {
    if (model.bodies[body].kind == BodyKind::inactive) continue;
    std::uint32_t beside = solver::GraphChange::front;
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (const std::uint32_t node = node_of_ring[model.particles[p].ring]; node != none) beside = node;
    });
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      const std::uint32_t ring = model.particles[p].ring;
      if (node_of_ring[ring] == none) {
        if (!model.is_unknown(model.particles[p])) return;
        for (const auto& [other, split_from] : change.local.rings)
          if (other == ring && split_from != none && node_of_ring[split_from] != none)
            beside = node_of_ring[split_from];
        add_node(model, ring, beside, node_of_ring);
      }
      changed.push_back(node_of_ring[ring]);
    });
  }
  sort_unique(changed);
  for (const std::uint32_t node : changed) {
    const std::uint32_t ring = nodes_.rings[node];
    nodes_.pinned[node] = is_needed(ring) && model.is_pinned(ring);
  }
}

}  // namespace iota::island
