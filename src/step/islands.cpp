// SPDX-License-Identifier: Apache-2.0
#include "step/islands.h"

#include <algorithm>

namespace iota::step {

using model::Model;
using model::none;

void Islands::forget() {
  island_of_leader_.clear(), leader_of_.clear(), next_member_.clear(), is_waiting_.clear();
  knows_all_ = false, order_is_old_ = true;
}

// Its articulates wait for a new one.
void Islands::drop(std::uint32_t leader) {
  island_of_leader_[leader].reset();
  for (std::uint32_t a = leader; a != none; a = next_member_[a]) {
    leader_of_[a] = none;
    if (!is_waiting_[a]) is_waiting_[a] = 1, waiting_.push_back(a);
  }
}

void Islands::update(Model& model) {
  model.take_touched(touched_);
  if (!knows_all_) {
    touched_.clear();
    model.articulates.for_each([&](std::uint32_t a, const model::Articulate&) { touched_.push_back(a); });
    knows_all_ = true;
  }
  if (touched_.empty()) return;
  order_is_old_ = true;
  const std::size_t slots = model.articulates.slot_count();
  island_of_leader_.resize(slots), leader_of_.resize(slots, none), next_member_.resize(slots, none);
  is_waiting_.resize(slots, 0);

  // 1. What was touched, and all that shared an island with it, is without one.
  waiting_.clear();
  for (const std::uint32_t a : touched_) {
    if (leader_of_[a] != none)
      drop(leader_of_[a]);
    else if (!is_waiting_[a])
      is_waiting_[a] = 1, waiting_.push_back(a);
  }

  // 2. Articulates that implicit bonds tie together are solved together: flood from each that waits.
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    if (!is_waiting_[waiting_[i]]) continue;  // an earlier flood came by
    if (!model.articulates.is_alive(waiting_[i])) {
      is_waiting_[waiting_[i]] = 0;
      continue;
    }
    members_.assign(1, waiting_[i]);
    is_waiting_[waiting_[i]] = 0;
    for (std::size_t next = 0; next < members_.size(); ++next)
      model.for_each_body_of(members_[next], [&](std::uint32_t body) {
        model.for_each_particle_of(body, [&](std::uint32_t p) {
          model.for_each_bond_of(p, [&](std::uint32_t b) {
            const model::Bond& bond = model.bonds[b];
            if (!bond.ties()) return;
            const std::uint32_t far = model.particles[bond.p == p ? bond.q : bond.p].body;
            const std::uint32_t a = model.bodies[far].articulate;
            if (leader_of_[a] != none) drop(leader_of_[a]);
            if (is_waiting_[a]) is_waiting_[a] = 0, members_.push_back(a);
          });
        });
      });
    std::sort(members_.begin(), members_.end());  // whoever found whom first
    const std::uint32_t leader = members_.front();
    for (std::size_t m = 0; m < members_.size(); ++m) {
      leader_of_[members_[m]] = leader;
      next_member_[members_[m]] = m + 1 < members_.size() ? members_[m + 1] : none;
    }
    island_of_leader_[leader] = std::make_unique<Island>();
    island_of_leader_[leader]->assemble(model, members_, node_of_ring_);
    island_of_leader_[leader]->carry_along(model);
  }
}

std::span<Island* const> Islands::all() {
  if (order_is_old_) {
    in_order_.clear();
    for (const auto& island : island_of_leader_)
      if (island) in_order_.push_back(island.get());
    order_is_old_ = false;
  }
  return in_order_;
}

}  // namespace iota::step
