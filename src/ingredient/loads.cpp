// SPDX-License-Identifier: Apache-2.0
#include "ingredient/loads.h"

#include "ingredient/ingredient_list.h"
#include "ingredient/model.h"

#include <algorithm>
#include <cmath>

namespace iota::ingredient {

using namespace model;

namespace {

bool moves_freely(const Model& model, std::uint32_t particle) {
  return is_free(model.bodies[model.particles[particle].body].kind);
}

/// The equation of motion of one body at one of its points, without its hinge: the sum of the loads there.
class PointBalance final : public LoadReader {
 public:
  PointBalance(const LastStep& step, std::uint32_t particle, ReadLoads read)
      : model_(step.model), point_(particle), index_(model_.particles[particle].basis_index) {
    read(step, model_.particles[particle].body, *this);
  }
  const Vec3& sum() const { return sum_; }

  void take(const Load& load) override {
    if (load.kind == Load::Kind::jump) return;
    if (const double w = weight(load); w != 0) sum_ += w * load.force;
  }

 private:
  /// The share of a load at the point.
  double weight(const Load& load) const {
    const Particle& p = model_.particles[load.particle];
    const bool through_basis = load.through_basis || p.basis_index >= 0 || !model_.is_unknown(p);
    if (!through_basis) return load.particle == point_;
    return index_ < 0 ? 0 : model_.weights(load.particle)[static_cast<std::size_t>(index_)];
  }

  const Model& model_;
  std::uint32_t point_;
  int index_;  // in the basis; -1: an unknown of its own
  Vec3 sum_;
};

/// Adds up the loads of one kind on a body or one part of it.
class PartLoads final : public LoadReader {
 public:
  PartLoads(const LastStep& step, std::uint32_t body, BodyId part, Load::Kind kind)
      : step_(step), part_(part), kind_(kind) {
    double mass = 0;
    step.model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (!counts(step.model.particles[p].part)) return;
      mass += step.model.particles[p].mass;
      center_ += step.model.particles[p].mass * place(p);
    });
    if (mass > 0) center_ = (1 / mass) * center_;
  }
  const Wrench& sum() const { return sum_; }
  bool counts(BodyId part) const { return !part_ || part == part_; }

  void take(const Load& load) override {
    if (load.kind != kind_ || !counts(load.part)) return;
    sum_.force += load.force;
    sum_.torque += cross(place(load.particle) - center_, load.force);
  }

 private:
  Vec3 place(std::uint32_t particle) const {
    return kind_ == Load::Kind::jump ? step_.end(particle) : step_.place(particle);
  }

  const LastStep& step_;
  BodyId part_;
  Load::Kind kind_;
  Vec3 center_;
  Wrench sum_;
};

/// Whether contacts, and nothing else, hold a body: they tell all of their impulse.
bool is_held_by_contacts(const Model& model, std::uint32_t body) {
  bool is_held = false, touches = false;
  model.contacts.for_each_of(body, [&](std::uint32_t) { touches = true; });
  if (!touches) return false;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const Ring& ring = model.rings[model.particles[p].ring];
    is_held = is_held || ring.count > 1 || ring.nailed || Joints::holds(model, p) || Closings::holds(model, p);
  });
  return !is_held;
}

solver::ForceStage stage_of(const model::Model& model, std::uint32_t particle) {
  if (particle != none && model.rings[model.particles[particle].ring].is_instant)
    return {.h = model.last_dt, .instant = true};
  return {.h = model.last_dt, .midpoint = !model.steps_to_end_point()};
}

}  // namespace

LastStep::LastStep(const model::Model& model, std::uint32_t particle)
    : model(model), stage(stage_of(model, particle)), structure_(model) {}

LastStep::Slowed LastStep::slowed(std::uint32_t particle) const {
  constexpr double most_of_half = 300;  // of more nothing is left
  Slowed sum;
  // A carried particle has the velocity of its basis, whose points have different damping.
  for (const auto& [slot, weight] : rings_that_carry(model, particle)) {
    const double rate = weight == 0 ? 0 : Masses::damping_rate(model, slot);
    if (!(rate > 0)) continue;
    const model::Ring& ring = model.rings[slot];
    if (stage.instant) {
      sum.at_end += (weight * rate * h()) * ring.velocity;
      continue;
    }
    const Vec3 start = ring.velocity - structure_.corrections[slot] - h() * ring.acceleration;
    const double half = std::min(rate * h() / 2, most_of_half);
    sum.at_start -= (weight * std::expm1(-half)) * start;
    sum.at_end += (weight * std::expm1(half)) * ring.velocity;
  }
  return sum;
}

Vec3 LastStep::damping(std::uint32_t particle) const {
  if (!(h() > 0)) return {};
  const Slowed by = slowed(particle);
  return (1 / h()) * (by.at_start + by.at_end);
}

Vec3 LastStep::moved(std::uint32_t particle) const {
  const Slowed by = stage.instant ? Slowed{} : slowed(particle);
  const Vec3 damped = ring(particle).velocity - structure_.corrections[structure_.particles[particle].ring];
  const Vec3 at_end = damped + by.at_end;
  if (!stage.midpoint) return h() * at_end;
  return (0.5 * h()) * (damped - h() * acceleration(particle) - by.at_start + at_end);
}

void read_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  add_loads<Ingredients>(step, body, reader);
}

Vec3 calc_hinge_force(const Model& model, std::uint32_t particle, ReadLoads read) {
  const std::uint32_t slot = model.particles[particle].ring;
  const Ring& ring = model.rings[slot];
  const bool free = moves_freely(model, particle);
  if (ring.count == 1) return ring.nailed && free ? -model.nails[slot].multiplier : Vec3{};
  const LastStep step(model, particle);
  Vec3 own, all;
  int count = 0;
  model.for_each_in_ring(slot, [&](std::uint32_t p) {
    if (!moves_freely(model, p)) return;
    const Vec3 force = -PointBalance(step, p, read).sum();
    all += force, ++count;
    if (p == particle) own = force;
  });
  if (!free) return -all;  // the residual of the others
  return model.is_pinned(slot) ? own : own - (1.0 / count) * all;
}

Wrench calc_outside_load(const Model& model, std::uint32_t body, BodyId part, ReadLoads read) {
  const LastStep step(model, model.bodies[body].first);
  PartLoads loads(step, body, part, Load::Kind::outside);
  read(step, body, loads);
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const BodyId own = model.particles[p].part;
    if (loads.counts(own)) loads.take({.particle = p, .force = calc_hinge_force(model, p, read), .part = own});
  });
  return loads.sum();
}

Wrench calc_net_load(const Model& model, std::uint32_t body, BodyId part, ReadLoads read) {
  const LastStep step(model, model.bodies[body].first);
  const auto change = [&](Load::Kind kind) {
    PartLoads loads(step, body, part, kind);
    read(step, body, loads);
    return loads.sum();
  };
  Wrench load = change(Load::Kind::inertia);
  if (is_held_by_contacts(model, body)) {
    const Wrench jump = change(Load::Kind::jump);
    load.force += jump.force;
    // By the end-point rule it also gives back the angular momentum that the step has lost.
    if (!model.steps_to_end_point()) load.torque += jump.torque;
  }
  return {-load.force, -load.torque};
}

}  // namespace iota::ingredient
