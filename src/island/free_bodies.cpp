// SPDX-License-Identifier: Apache-2.0
#include "island/free_bodies.h"

#include "base/slack.h"
#include "ingredient/ingredient_list.h"
#include "ingredient/noise.h"
#include "laws/velocity_part.h"
#include "math/damped_flight.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iota::island {

using model::Model;

bool FreeBodies::is_free(const Model& model, std::uint32_t articulate) {
  const model::Articulate& a = model.articulates[articulate];
  if (a.count != 1) return false;
  const model::Body& body = model.bodies[a.first];
  if (body.count == 0 || !model::is_free(body.kind)) return false;
  bool is_held = body.count == 1 && !(model.particles[body.first].mass > 0);
  model.for_each_particle_of(a.first, [&](std::uint32_t p) {
    const model::Ring& ring = model.rings[model.particles[p].ring];
    is_held = is_held || ring.count != 1 || ring.nailed;
    ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() { is_held = is_held || I::holds(model, p); });
  });
  return !is_held;
}

void FreeBodies::set(std::uint32_t articulate, bool free) {
  if (articulates_.size() <= articulate) {
    if (!free) return;
    articulates_.resize(articulate + 1, 0);
  }
  is_old_ = is_old_ || articulates_[articulate] || free;
  articulates_[articulate] = free;
}

void FreeBodies::refresh(const Model& model) {
  if (!is_old_) return;
  is_old_ = false;
  ++version_;
  awake_.clear(), still_.clear();
  loose_.clear();
  for (std::uint32_t a = 0; a < articulates_.size(); ++a) {
    if (!articulates_[a]) continue;
    const std::uint32_t body = model.articulates[a].first, particle = model.bodies[body].first;
    if (is_resting(model, a))
      still_.push_back(body);
    else if (is_particle(model, a))
      awake_.push_back({a, body, particle, model.particles[particle].ring});
    else
      reserve_a_quarter(loose_), loose_.push_back({a, body});
  }
}

void FreeBodies::put_to_rest(Model& model, std::uint32_t articulate) {
  rest(model, articulate);
  is_old_ = true;
}

void FreeBodies::rest(Model& model, std::uint32_t articulate) {
  model::Body& body = model.bodies[model.articulates[articulate].first];
  body.kind = BodyKind::resting;
  model.stop_ring(model.particles[body.first].ring);
}

void FreeBodies::wake(Model& model, std::uint32_t articulate) {
  model::Articulate& a = model.articulates[articulate];
  a.slow_time = 0;
  const auto loose = std::ranges::lower_bound(loose_, articulate, {}, &Loose::articulate);
  if (loose != loose_.end() && loose->articulate == articulate) loose->book_epoch = 0;
  if (model.bodies[a.first].kind != BodyKind::resting) return;
  model.bodies[a.first].kind = BodyKind::dynamic;
  is_old_ = true;
}

std::size_t FreeBodies::size(const Model& model) {
  refresh(model);
  return awake_.size() + loose_.size() + still_.size();
}

std::uint32_t FreeBodies::frozen() const {
  return static_cast<std::uint32_t>(std::ranges::count_if(loose_, &Loose::is_frozen));
}

void FreeBodies::add_awake(const Model& model, std::uint64_t epoch, ingredient::Book& book) {
  for (const FreeParticle& free : awake_) book.add(ingredient::calc_book(model, {&free.body, 1}));
  for (Loose& loose : loose_) {
    if (!loose.is_frozen || loose.book_epoch != epoch) {
      loose.book = ingredient::calc_book(model, {&loose.body, 1});
      loose.book_epoch = loose.is_frozen ? epoch : 0;
    }
    book.add(loose.book);
  }
}

bool FreeBodies::Loose::goes_on_by_itself(Model& model, double h) {
  using ingredient::Strides;
  is_frozen = false;
  if (!Strides::any(model)) return false;
  const auto visit_rings = [&](auto visit) {
    model.for_each_particle_of(body, [&](std::uint32_t p) { visit(model.particles[p].ring); });
  };
  const Strides::Phase phase = Strides::phase(model, h, visit_rings);
  is_frozen = phase == Strides::Phase::none && Strides::of(model, body) == Strides::frozen;
  if (phase != Strides::Phase::within && !is_frozen) return false;
  const std::uint32_t first = model.particles[model.bodies[body].first].ring;
  if (!is_frozen) {
    const auto steps = static_cast<std::uint32_t>(model.step + 1 - Strides::find(model, first)->begin);
    visit_rings([&](std::uint32_t ring) { Strides::show(model, ring, steps); });
  }
  Strides::drop_forces(model, body);
  report = {}, rests = false;
  return true;
}

namespace {

/// Renews what a particle gains of a force that depends on its velocity, which is known for the one at the start of the step. `before`:
/// after half of the damping. Returns the part of the force that does no work.
/// Apart from the loop over particles, few of which have such a force: within it, it took a third of the time of the others.
[[gnu::noinline]] Vec3 push_by_velocity(Model& model, std::uint32_t ring, double mass, double h, const Vec3& start,
                                        const Vec3& before, Vec3& gained) {
  const Mat3& rate = model.pushes_by_velocity.find(ring)->rate;
  laws::VelocityPart part(rate, mass);
  part.begin(h);
  gained += (h / mass) * (rate * (before - start));
  gained = solve(Mat3::diagonal(1) + (-h / mass) * part.rate(), gained);
  model.pushes.find(ring)->before = (mass / h) * gained - mass * model.acting_gravity();
  return part.turn(before + 0.5 * gained);
}

/// After a flight that began with half of the damping: `left` is the share of a velocity that a half leaves.
DampedFlight damp_flight(const Vec3& start, const DampedFlight& flight, double left) {
  const Vec3& after = flight.after;
  return {left * after, flight.moved, 0.5 * (1 - left * left) * (dot(start, start) + dot(after, after))};
}

}  // namespace

solver::AdvanceReport FreeBodies::advance(Model& model, double h, const Parallel& parallel) {
  refresh(model);
  resting_ = still();
  for (const Loose& loose : loose_) resting_ += loose.rests, is_old_ = is_old_ || loose.rests;
  solver::AdvanceReport report;
  if (awake_.empty()) return report;
  constexpr std::size_t chunk = 4096;  // sums are over chunks, so that they do not depend on the number of threads
  const std::size_t chunks = (awake_.size() + chunk - 1) / chunk;
  shares_.assign(chunks, {});
  const bool robust = model.steps_to_end_point(), is_accurate = model.mode == IntegrationMode::accurate;
  const bool has_strides = ingredient::Strides::any(model);
  const Vec3 gravity = model.acting_gravity();
  parallel.for_each(chunks, 1, [&](std::size_t c) {
    Share share;
    for (std::size_t i = c * chunk; i < std::min(awake_.size(), (c + 1) * chunk); ++i) {
      const FreeParticle& free = awake_[i];
      if (has_strides && ingredient::Strides::is_frozen(model, free.body)) [[unlikely]] {
        ingredient::Strides::drop_forces(model, free.body);
        continue;
      }
      model::Ring& ring = model.rings[free.ring];
      ingredient::Push* const push = model.pushes.find(free.ring);
      if (push) push->before = std::exchange(push->force, Vec3{});
      const Vec3 force = push ? push->before : Vec3{};
      const double mass = model.particles[free.particle].mass;
      const double damping = model.damping + model.body_damping[free.body];
      const Vec3 start = ring.velocity;
      Vec3 before = start;
      double left = 1;  // by half of the damping, which acts before the rest and after it, as Integrator::damp
      if (damping > 0) [[unlikely]]
        left = std::exp(-0.5 * damping * h), before *= left;
      Vec3 gained = h * ((1 / mass) * force + gravity);
      Vec3 turning;
      if (push && model.pushes_by_velocity.has(free.ring)) [[unlikely]]
        turning = push_by_velocity(model, free.ring, mass, h, start, before, gained);
      Vec3 after = before + gained, moved = h * (robust ? after : 0.5 * (before + after));
      constexpr double absurd = 1e12;  // m/s: the energy of a higher speed would overflow
      if (!(dot(after, after) < absurd * absurd) || !is_finite(moved))
          [[unlikely]] {  // an extreme force: the particle keeps its place, and the report says so
        share.is_stuck = true;
        continue;
      }
      if (damping > 0) [[unlikely]] {
        const bool is_exact = is_accurate && !(push && model.pushes_by_velocity.has(free.ring));
        const DampedFlight flight =
            is_exact ? fly_damped(start, (1 / h) * gained, damping, h) : damp_flight(start, {after, moved}, left);
        after = flight.after, moved = flight.moved, share.dissipated += mass * flight.taken;
      }
      ring.velocity = after;
      ring.position += moved;
      if (push) share.work += dot(push->before - turning, moved);
      if (robust) share.lost += 0.5 * mass * dot(gained, gained) - dot(turning, moved);
      const bool pushed = !ingredient::is_noise(model, force, mass);
      ring.acceleration = (1 / h) * (ring.velocity - start);
      model.corrections.set(free.ring, {}), ring.is_instant = 0;
      if (model.rest_after > 0) {
        const double speed2 = dot(ring.velocity, ring.velocity);
        double& slow_time = model.articulates[free.articulate].slow_time;
        slow_time = !pushed && speed2 < model.rest_speed * model.rest_speed ? slow_time + h : 0;
        if (slow_time >= model.rest_after) {
          share.lost += 0.5 * mass * speed2;
          rest(model, free.articulate);
          ++share.resting;
        }
      }
    }
    shares_[c] = share;
  });
  for (const Share& share : shares_) {
    resting_ += share.resting, is_old_ = is_old_ || share.resting > 0;
    report.dissipated += share.dissipated, report.lost += share.lost, report.external_work += share.work;
    report.converged = report.converged && !share.is_stuck;
  }
  return report;
}

}  // namespace iota::island
