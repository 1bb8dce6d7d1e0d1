// SPDX-License-Identifier: Apache-2.0
#include "step/joined_bodies.h"

#include <algorithm>
#include <utility>

namespace iota::step {

namespace {

/// visit(body): of those that the ring, closings and joints of a particle hold at its body; some of them more than once.
template <class Visit>
void for_each_joined_at(const model::Model& model, std::uint32_t p, Visit visit) {
  const model::Particle& particle = model.particles[p];
  if (model.rings[particle.ring].count > 1)
    model.for_each_in_ring(particle.ring, [&](std::uint32_t q) { visit(model.particles[q].body); });
  if (model.closings.size() > 0) ingredient::Closings::visit_joined(model, p, visit);
  // Also of a point that is no unknown, as it follows from those of its body.
  if (ingredient::Joints::ties_any(model)) ingredient::Joints::visit_held(model, p, visit);
}

}  // namespace

bool JoinedBodies::are_joined(const model::Model& model, std::uint32_t a, std::uint32_t b) {
  const auto [fewer, other] = model.bodies[a].count <= model.bodies[b].count ? std::pair(a, b) : std::pair(b, a);
  bool any = false;
  model.for_each_particle_of(fewer, [&](std::uint32_t p) {
    if (!any) for_each_joined_at(model, p, [&](std::uint32_t body) { any = any || body == other; });
  });
  return any;
}

void JoinedBodies::forget() {
  ++look_, has_welds_.reset();
  groups_.clear(), members_.clear(), neighbors_.clear();
}

bool JoinedBodies::has_welds(const model::Model& model) {
  if (!has_welds_) {
    has_welds_ = false;
    model.constraints.for_each([&](std::uint32_t, const ingredient::Constraint& c) {
      has_welds_ = *has_welds_ || c.kind == ConstraintKind::weld;
    });
  }
  return *has_welds_;
}

bool JoinedBodies::are_joined_by_welds(const model::Model& model, std::uint32_t a, std::uint32_t b) {
  if (!has_welds(model)) return false;
  std::uint32_t fewer = group_of(model, a), more = group_of(model, b);
  if (fewer == more) return true;
  if (groups_[fewer].members.count > groups_[more].members.count) std::swap(fewer, more);
  if (groups_[fewer].is_fixed && groups_[more].is_fixed) return true;
  if (groups_[more].members.count == 1) return false;
  list_neighbors(model, fewer);
  const Range at = groups_[fewer].neighbors;
  return std::binary_search(neighbors_.begin() + at.first, neighbors_.begin() + at.first + at.count, more);
}

std::span<const std::uint32_t> JoinedBodies::welded_to(const model::Model& model, std::uint32_t body) {
  const Range at = groups_[group_of(model, body)].members;
  return std::span(members_).subspan(at.first, at.count);
}

std::uint32_t JoinedBodies::group_of(const model::Model& model, std::uint32_t body) {
  if (found_.size() < model.bodies.slot_count()) found_.resize(model.bodies.slot_count());
  if (found_[body].look == look_) return found_[body].group;
  const auto group = static_cast<std::uint32_t>(groups_.size());
  const auto add = [&](std::uint32_t member) {
    if (found_[member].look == look_) return;
    found_[member] = {look_, group}, members_.push_back(member);
  };
  const auto first = static_cast<std::uint32_t>(members_.size());
  bool is_fixed = false;
  add(body);
  for (std::size_t i = first; i < members_.size(); ++i) {
    if (model.bodies[members_[i]].kind == BodyKind::static_) break;  // it is alone
    model.for_each_particle_of(members_[i], [&](std::uint32_t p) {
      ingredient::Joints::visit_welded(model, p, [&](std::uint32_t other) {
        if (other == model::none || model.bodies[other].kind == BodyKind::static_)
          is_fixed = true;
        else
          add(other);
      });
    });
  }
  groups_.push_back({.members = {first, static_cast<std::uint32_t>(members_.size()) - first}, .is_fixed = is_fixed});
  return group;
}

void JoinedBodies::list_neighbors(const model::Model& model, std::uint32_t group) {
  if (groups_[group].has_neighbors) return;
  const Range members = groups_[group].members;
  const auto first = static_cast<std::ptrdiff_t>(neighbors_.size());
  for (std::uint32_t i = 0; i < members.count; ++i)
    model.for_each_particle_of(members_[members.first + i], [&](std::uint32_t p) {
      for_each_joined_at(model, p, [&](std::uint32_t body) { neighbors_.push_back(group_of(model, body)); });
    });
  std::sort(neighbors_.begin() + first, neighbors_.end());
  neighbors_.erase(std::unique(neighbors_.begin() + first, neighbors_.end()), neighbors_.end());
  groups_[group].neighbors = {static_cast<std::uint32_t>(first),
                              static_cast<std::uint32_t>(neighbors_.size()) - static_cast<std::uint32_t>(first)};
  groups_[group].has_neighbors = true;
}

}  // namespace iota::step
