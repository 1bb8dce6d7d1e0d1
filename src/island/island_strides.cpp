// SPDX-License-Identifier: Apache-2.0
// Islands that are not solved in each step: see ingredient/strides.h. A stride of n steps is one step of n times the length,
// stored at its begin: multipliers, angles and accounts are then those at its end, and rings go there by their tracks. It
// was tried to solve it at the end instead, and to extrapolate until then: what fell went through the ground for up to seven
// steps, and jumped back.
#include "island/island.h"

#include "ingredient/quantities.h"

#include <algorithm>

namespace iota::island {

using ingredient::Strides;
using ingredient::Track;
using ingredient::Unused;
using model::Model;
using model::none;

namespace {

/// A nailed particle, from which something hangs by a spring, wants no stride of its own.
bool may_move(const Model& model, std::uint32_t body) {
  if (!model::is_free(model.bodies[body].kind)) return false;
  bool any = false;
  model.for_each_particle_of(body, [&](std::uint32_t p) { any = any || !model.rings[model.particles[p].ring].nailed; });
  return any;
}

/// Whether a stride of one of them is over, and no step has followed it.
bool follows_stride(const Model& model, std::span<const std::uint32_t> bodies) {
  if (model.tracks.is_empty()) return false;
  return std::any_of(bodies.begin(), bodies.end(), [&](std::uint32_t body) {
    const std::uint32_t first = model.bodies[body].first;
    const Track* const track = first == none ? nullptr : Strides::find(model, model.particles[first].ring);
    return track && track->length > 1 && !Strides::is_within(model, *track);
  });
}

}  // namespace

std::uint32_t Island::agree_on_stride(Model& model) {
  if (stride_ != 0) return stride_;
  std::uint32_t shortest = Strides::frozen;
  bool any = false;
  for (const std::uint32_t body : nodes_.bodies)
    if (may_move(model, body)) shortest = std::min(shortest, Strides::of(model, body)), any = true;
  stride_ = any && !idle_ ? shortest : 1;
  if (!any || idle_) return stride_;  // nailed points alone keep theirs: they may be of a thing that is frozen
  for (const std::uint32_t body : nodes_.bodies)
    if (model::is_free(model.bodies[body].kind)) Strides::set(model, body, stride_ == Strides::frozen ? 0 : stride_);
  if (stride_ > 1 && stride_ != Strides::frozen)
    for_each_ring(model, [&](std::uint32_t ring) { (void)model.tracks.make(ring); });
  return stride_;
}

const solver::AdvanceReport& Island::advance(Model& model, double h, const Limits& limits) {
  if (!Strides::any(model) || idle_ || stays_asleep(model)) return solve(model, h, limits);
  const auto visit_rings = [&](auto visit) { for_each_ring(model, visit); };
  const Strides::Phase phase = Strides::phase(model, h, visit_rings);
  const auto skip = [&]() -> const solver::AdvanceReport& {
    for (const std::uint32_t body : nodes_.bodies) Strides::drop_forces(model, body);
    last_ = {}, has_stepped_ = true;
    return last_;
  };
  if (phase == Strides::Phase::within) {
    const auto steps = static_cast<std::uint32_t>(model.step + 1 - Strides::find(model, nodes_.rings.front())->begin);
    visit_rings([&](std::uint32_t ring) { Strides::show(model, ring, steps); });
    return skip();
  }
  Unused unused;
  if (phase == Strides::Phase::broken) unused = leave_stride(model);
  const std::uint32_t steps =
      stride_ > 1 && stride_ != Strides::frozen ? Strides::length(model, stride_, nodes_.bodies, h) : 1;
  // A long step leaves wider gaps than a short one may have: their closing would make energy, 3e-6 J of 4 J.
  if (steps == 1 && stride_ != Strides::frozen && follows_stride(model, nodes_.bodies)) (void)leave_stride(model);
  if (stride_ == Strides::frozen) {
    wake_bodies(model);
    is_still_ = is_frozen_ = true;
    (void)skip();
  } else if (steps == 1) {
    (void)solve(model, h, limits);
  } else {
    begin_stride(model, h, steps, limits);
  }
  return take_back(unused);
}

// An island with a body that meets something so fast takes every step: the search of contacts has ended its stride.
const solver::AdvanceReport& Island::advance_part(Model& model, double part, const Limits& limits) {
  const auto visit_rings = [&](auto visit) { for_each_ring(model, visit); };
  Unused unused;
  if (Strides::any(model) && Strides::phase(model, part, visit_rings) != Strides::Phase::none)
    unused = leave_stride(model);
  (void)solve(model, part, limits);
  return take_back(unused);
}

const solver::AdvanceReport& Island::solve(Model& model, double h, const Limits& limits) {
  solved_steps_ = 1;
  if (std::exchange(tried_ahead_, 0) != h) try_step(model, h, limits);
  return commit(model, h);
}

void Island::begin_stride(Model& model, double h, std::uint32_t steps, const Limits& limits) {
  Track common;
  common.h = h, common.begin = model.step, common.length = steps, common.leader = nodes_.rings.front();
  for_each_ring(model, [&](std::uint32_t ring) {
    Track& track = model.tracks.at(ring);
    track.from = model.rings[ring].position, track.velocity_from = model.rings[ring].velocity;
    ++common.points;
  });
  for (const std::uint8_t pinned : nodes_.pinned) common.is_pinned |= pinned;
  common.energy_from = ingredient::calc_energies(model, nodes_.bodies).total();
  try_step(model, steps * h, limits);
  (void)commit(model, steps * h);
  solved_steps_ = steps;
  if (is_still_) return;  // it fell asleep
  common.energy_to = ingredient::calc_energies(model, nodes_.bodies).total();
  common.dissipated = last_.dissipated / common.points, common.external_work = last_.external_work / common.points;
  for_each_ring(model, [&](std::uint32_t ring) {
    Track& track = model.tracks.at(ring);
    common.from = track.from, common.velocity_from = track.velocity_from;
    common.to = model.rings[ring].position, common.velocity_to = model.rings[ring].velocity;
    track = common;
    Strides::show(model, ring, 1);
  });
}

Unused Island::leave_stride(Model& model) {
  const bool is_pinned = nodes_.pinned_count() > 0;
  const Unused unused = Strides::abandon(model, nodes_.bodies);
  const double limit = ingredient::calc_energies(model, nodes_.bodies).total();
  (void)project(model, true);
  Strides::limit_energy(model, nodes_.bodies, limit, is_pinned);
  return unused;
}

const solver::AdvanceReport& Island::take_back(const Unused& unused) {
  last_.dissipated -= unused.dissipated, last_.external_work -= unused.external_work, last_.lost -= unused.lost();
  return last_;
}

}  // namespace iota::island
