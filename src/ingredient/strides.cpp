// SPDX-License-Identifier: Apache-2.0
#include "ingredient/strides.h"

#include "base/sort_unique.h"
#include "base/text.h"
#include "ingredient/model.h"
#include "ingredient/quantities.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace iota::ingredient {

namespace {

/// Each once, in order.
std::vector<std::uint32_t> rings_of(const Model& model, std::span<const std::uint32_t> bodies) {
  std::vector<std::uint32_t> rings;
  for (const std::uint32_t body : bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) { rings.push_back(model.particles[p].ring); });
  sort_unique(rings);
  return rings;
}

Unused unused_of(const Model& model, const Track& track) {
  if (!Strides::is_within(model, track)) return {};
  const double share = 1 - static_cast<double>(model.step - track.begin) / track.length;
  return {share * track.dissipated, share * track.external_work};
}

/// Adds kinetic energy, J, by scaling all velocities relative to their mean, or all of them where something is pinned.
void add_kinetic_energy(Model& model, std::span<const std::uint32_t> bodies, double energy, bool is_pinned) {
  constexpr double least = 0.5, most = 1.1;  // of the energy: an interpolation misses far less
  const std::vector<std::uint32_t> rings = rings_of(model, bodies);
  double mass = 0;
  Vec3 momentum;
  for (const std::uint32_t ring : rings) {
    const double m = model.ring_mass(ring);
    mass += m, momentum += m * model.rings[ring].velocity;
  }
  if (!(mass > 0)) return;
  const Vec3 mean = is_pinned ? Vec3{} : (1 / mass) * momentum;
  const double relative = calc_energies(model, bodies).kinetic - 0.5 * mass * dot(mean, mean);
  if (!(relative > 1e-12 * std::abs(energy))) return;
  const double factor = std::sqrt(std::clamp(1 + energy / relative, least, most));
  for (const std::uint32_t ring : rings) {
    Vec3& velocity = model.rings[ring].velocity;
    velocity = mean + factor * (velocity - mean);
  }
}

}  // namespace

void Strides::check_links(const Model& model, model::Audit& audit) {
  model.strides.for_each([&](std::uint32_t body, std::uint32_t steps) {
    const std::uint32_t own = steps & ~newer;
    audit.require(own != 1 && own <= longest, "body ", body, " has a stride of ", own, " steps");
  });
  model.tracks.for_each([&](std::uint32_t ring, const Track& t) {
    const bool is_finite = std::isfinite(dot(t.from, t.from) + dot(t.to, t.to) + dot(t.velocity_from, t.velocity_from) +
                                         dot(t.velocity_to, t.velocity_to) + t.h + t.energy_from + t.energy_to);
    audit.require(is_finite && t.length <= longest && t.begin <= model.step, "the track of ring ", ring, " is damaged");
  });
}

void Strides::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a stride", model.strides, model.bodies);
  audit.require_owners("a track", model.tracks, model.rings);
}

void Strides::forget_body(Model& model, std::uint32_t body) { model.strides.erase(body); }

void Strides::ring_changed(Model& model, std::uint32_t ring) {
  if (model.rings[ring].count > 0) return;
  if (const Track* const track = find(model, ring)) {
    const Unused unused = unused_of(model, *track);
    model.dissipated -= unused.dissipated, model.external_work -= unused.external_work, model.lost -= unused.lost();
  }
  model.tracks.erase(ring);
}

void Strides::apply(Model& model, const SetStride& c) {
  const std::uint32_t body = model::require(model, c.body);
  if (c.steps > longest)
    throw std::invalid_argument(
        text("stride must be 1 (every step) to ", longest, " steps, or 0 (frozen), got ", c.steps));
  const model::Articulate& articulate = model.articulates[model.bodies[body].articulate];
  const bool is_edited = articulate.to_wake || articulate.velocity_dirty;
  const auto set_one = [&](std::uint32_t b) {
    set(model, b, c.steps);
    if (std::uint32_t* const steps = model.strides.find(b); steps && is_edited) *steps |= newer;
  };
  if (c.whole)
    model.for_each_body_of(model.bodies[body].articulate, set_one);
  else
    set_one(body);
}

bool Strides::any(const Model& model) { return !model.strides.is_empty() || !model.tracks.is_empty(); }

std::uint32_t Strides::of(const Model& model, std::uint32_t body) {
  const std::uint32_t* const steps = model.strides.find(body);
  if (!steps) return 1;
  return (*steps & ~newer) == 0 ? frozen : *steps & ~newer;
}

void Strides::set(Model& model, std::uint32_t body, std::uint32_t steps) {
  const std::uint32_t before = of(model, body);
  if (before == (steps == 0 ? frozen : steps)) return;
  if (steps == 0 || before == frozen) model.changed_freezes.note(body);
  if (steps == 1)
    model.strides.erase(body);
  else
    model.strides.make(body) = steps;
  model.changed_strides.push_back(body);
}

void Strides::disturb(Model& model, std::uint32_t body) {
  if (!any(model)) return;
  model.for_each_body_of(model.bodies[body].articulate, [&](std::uint32_t b) {
    std::uint32_t* const steps = model.strides.find(b);
    if (steps && (*steps & newer))
      *steps &= ~newer;
    else
      set(model, b, 1);
    model.for_each_particle_of(b, [&](std::uint32_t p) {
      if (Track* const track = model.tracks.find(model.particles[p].ring)) track->points = 0;
    });
  });
}

void Strides::disturb_edited(Model& model) {
  if (!any(model)) return;
  for (const std::uint32_t articulate : model.flagged())
    if (model.articulates.is_alive(articulate) && model.articulates[articulate].first != none)
      disturb(model, model.articulates[articulate].first);
  model.grips.for_each([&](std::uint32_t, const Grip& grip) { disturb(model, grip.body); });
}

const Track* Strides::find(const Model& model, std::uint32_t ring) { return model.tracks.find(ring); }

bool Strides::is_within(const Model& model, const Track& track) { return track.is_active(model.step); }

bool Strides::is_frozen(const Model& model, std::uint32_t body) {
  if (model.strides.is_empty() || of(model, body) != frozen) return false;
  const std::uint32_t first = model.bodies[body].first;
  const Track* const track = first == none ? nullptr : find(model, model.particles[first].ring);
  return !(track && is_within(model, *track));
}

bool Strides::skips(const Model& model, std::uint32_t body) {
  if (!any(model)) return false;
  if (of(model, body) == frozen) return true;
  const std::uint32_t first = model.bodies[body].first;
  const Track* const track = first == none ? nullptr : find(model, model.particles[first].ring);
  return track && track->points > 0 && is_within(model, *track);
}

bool Strides::waits(const Model& model, std::uint32_t body, std::uint32_t ring, double h) {
  if (!skips(model, body)) return false;
  const Track* const track = find(model, ring);
  return !track || !is_within(model, *track) || (track->points > 0 && track->h == h);
}

std::uint32_t Strides::length(const Model& model, std::uint32_t stride, std::span<const std::uint32_t> bodies,
                              double h) {
  constexpr double largest_turn = 0.7;  // rad: the parabola is then off by 1e-3 of a link
  const std::uint64_t beat = model.step + ((bodies.front() * 2654435761u) >> 16);
  auto steps = static_cast<std::uint32_t>(stride - beat % stride);
  double fastest = 0;  // rad/s, squared
  for (const std::uint32_t slot : bodies) {
    const model::Body& body = model.bodies[slot];
    bool touches = false;
    if (model.contacts.size() > 0) model.contacts.for_each_of(slot, [&](std::uint32_t) { touches = true; });
    if (touches || (slot < model.near_since.size() && model.near_since[slot] == model.step + 1)) return 1;
    for (std::size_t k = 1; k < body.rank; ++k) {
      const std::uint32_t p = body.basis[0], q = body.basis[k];
      const Vec3 arm = model.position(q) - model.position(p), speed = model.velocity(q) - model.velocity(p);
      if (const double length2 = dot(arm, arm); length2 > 0) fastest = std::max(fastest, dot(speed, speed) / length2);
    }
  }
  const double turn = std::sqrt(fastest) * h;
  while (steps > 1 && turn * steps > largest_turn) steps /= 2;
  return steps;
}

void Strides::note_near(Model& model, std::uint32_t body) {
  if (model.near_since.size() <= body) model.near_since.resize(model.bodies.slot_count(), 0);
  model.near_since[body] = model.step + 1;
}

void Strides::show(Model& model, std::uint32_t ring, std::uint32_t steps) {
  const Track& t = model.tracks.at(ring);
  model::Ring& r = model.rings[ring];
  if (steps >= t.length) {
    r.position = t.to, r.velocity = t.velocity_to;
    return;
  }
  // The cubic of Hermite. Its derivative is the same as the mean of the velocities for the mid-point rule alone: the end-point
  // rule goes the whole way with the last velocity, and the derivative would have more energy than both ends.
  const double whole = t.length * t.h, s = static_cast<double>(steps) / t.length;
  r.position = t.from + (s * s * (3 - 2 * s)) * (t.to - t.from) + (whole * s * (1 - s) * (1 - s)) * t.velocity_from -
               (whole * s * s * (1 - s)) * t.velocity_to;
  r.velocity = (1 - s) * t.velocity_from + s * t.velocity_to;
}

void Strides::drop_forces(Model& model, std::uint32_t body) {
  if (Torque* const torque = model.torques.find(body)) torque->before = std::exchange(torque->torque, Vec3{});
  if (model.pushes.is_empty()) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (Push* const push = model.pushes.find(model.particles[p].ring))
      push->before = std::exchange(push->force, Vec3{});
  });
}

// Interpolated velocities of what turns have too little energy, by a^2/4 of it for a turn by a. An island that others have
// joined is several former ones: each gets its own energy, unless a part of it is elsewhere.
Unused Strides::abandon(Model& model, std::span<const std::uint32_t> bodies) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> members;  // leader, body
  for (const std::uint32_t body : bodies) {
    const std::uint32_t first = model.bodies[body].first;
    const Track* const track = first == none ? nullptr : find(model, model.particles[first].ring);
    if (track && is_within(model, *track) && track->points > 0) members.push_back({track->leader, body});
  }
  std::sort(members.begin(), members.end());
  std::vector<std::uint32_t> group;
  for (auto begin = members.begin(); begin != members.end();) {
    const auto end = std::find_if(begin, members.end(), [&](const auto& m) { return m.first != begin->first; });
    group.clear();
    for (; begin != end; ++begin) group.push_back(begin->second);
    const std::vector<std::uint32_t> rings = rings_of(model, group);
    const Track* const track = find(model, rings.front());
    const bool is_whole =
        track && rings.size() == track->points && std::all_of(rings.begin(), rings.end(), [&](std::uint32_t ring) {
          const Track* const other = find(model, ring);
          return other && are_of_one_stride(*other, *track);
        });
    if (!is_whole) continue;
    const double share = static_cast<double>(model.step - track->begin) / track->length;
    const double energy = track->energy_from + share * (track->energy_to - track->energy_from);
    add_kinetic_energy(model, group, energy - calc_energies(model, group).total(), track->is_pinned != 0);
  }
  Unused sum;
  for (const std::uint32_t ring : rings_of(model, bodies)) {
    Track* const track = model.tracks.find(ring);
    if (!track) continue;
    const Unused unused = unused_of(model, *track);
    sum.dissipated += unused.dissipated, sum.external_work += unused.external_work;
    track->length = 0;
  }
  return sum;
}

void Strides::limit_energy(Model& model, std::span<const std::uint32_t> bodies, double limit, bool is_pinned) {
  const double energy = calc_energies(model, bodies).total();
  if (energy > limit) add_kinetic_energy(model, bodies, limit - energy, is_pinned);
}

}  // namespace iota::ingredient
