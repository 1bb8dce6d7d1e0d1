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

void Islands::update(Model& model, const Parallel& parallel) {
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
  waiting_.clear(), fresh_.clear();
  for (const std::uint32_t a : touched_) {
    if (leader_of_[a] != none)
      drop(leader_of_[a]);
    else if (!is_waiting_[a])
      is_waiting_[a] = 1, waiting_.push_back(a);
  }

  // 2. Articulates that implicit bonds and constraints tie together are solved together: flood from each that waits.
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
          const auto reach = [&](std::uint32_t far) {
            const std::uint32_t a = model.bodies[far].articulate;
            if (leader_of_[a] != none) drop(leader_of_[a]);
            if (is_waiting_[a]) is_waiting_[a] = 0, members_.push_back(a);
          };
          model.for_each_bond_of(p, [&](std::uint32_t b) {
            const model::Bond& bond = model.bonds[b];
            if (bond.ties()) reach(model.particles[bond.p == p ? bond.q : bond.p].body);
          });
          model.for_each_body_tied_to(p, reach);
        });
      });
    std::sort(members_.begin(), members_.end());  // whoever found whom first
    const std::uint32_t leader = members_.front();
    for (std::size_t m = 0; m < members_.size(); ++m) {
      leader_of_[members_[m]] = leader;
      next_member_[members_[m]] = m + 1 < members_.size() ? members_[m + 1] : none;
    }
    fresh_.push_back(leader);
  }

  // 3. Build them; each by itself, so at once where there are many.
  node_of_ring_.resize(model.rings.slot_count(), none);
  for (const std::uint32_t leader : fresh_) island_of_leader_[leader] = std::make_unique<Island>();
  parallel.for_each(fresh_.size(), 8, [&](std::size_t i) {
    std::vector<std::uint32_t> members;
    for (std::uint32_t a = fresh_[i]; a != none; a = next_member_[a]) members.push_back(a);
    for (const std::uint32_t a : members)
      model.for_each_body_of(a, [&](std::uint32_t body) { model.prefer_unknowns(body); });
    Island& island = *island_of_leader_[fresh_[i]];
    island.assemble(model, members, node_of_ring_);
    island.carry_along(model);
  });
}

std::span<Island* const> Islands::all() {
  if (order_is_old_) {
    in_order_.clear();
    total_size_ = largest_size_ = 0;
    for (const auto& island : island_of_leader_) {
      if (!island) continue;
      in_order_.push_back(island.get());
      total_size_ += island->size();
      largest_size_ = std::max(largest_size_, island->size());
    }
    order_is_old_ = false;
  }
  return in_order_;
}

std::size_t Islands::grain(const Parallel& parallel) {
  (void)all();
  // A second thread takes about 20 us to join in; a point takes about a quarter of one. Where one island is most of the
  // work there is nothing to share out.
  constexpr std::size_t worthwhile = 400;  // points
  if (parallel.threads() == 1 || total_size_ - largest_size_ < worthwhile) return in_order_.size();
  return std::max<std::size_t>(1, in_order_.size() * 64 / total_size_);
}

}  // namespace iota::step
