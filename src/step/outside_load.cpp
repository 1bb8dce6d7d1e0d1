// SPDX-License-Identifier: Apache-2.0
#include "step/outside_load.h"

#include "ingredient/joint_readings.h"
#include "step/hinge_force.h"

#include <cmath>

namespace iota::step {

using namespace model;

namespace {

/// A share of what was applied to a place that several bodies have in common, as `calc_hinge_force` counts it.
Vec3 applied_to(const Model& model, std::uint32_t particle) {
  const Vec3& applied = model.pushes[model.particles[particle].ring].before;
  int free = 0;
  model.for_each_in_ring(model.particles[particle].ring,
                         [&](std::uint32_t p) { free += is_free(model.bodies[model.particles[p].body].kind); });
  return free > 1 ? (1.0 / free) * applied : applied;
}

class PartBalance {
 public:
  PartBalance(const Model& model, std::uint32_t body, BodyId part)
      : model_(model), body_(body), part_(part), back_(model.steps_to_end_point() ? 0 : model.last_dt / 2) {
    double mass = 0;
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (model.particles[p].part != part) return;
      mass += model.particles[p].mass;
      center_ += model.particles[p].mass * place(p);
    });
    if (mass > 0) center_ = (1 / mass) * center_;
  }

  OutsideLoad load() {
    model_.for_each_particle_of(body_, [&](std::uint32_t p) {
      if (model_.particles[p].part == part_) add_forces_on(p);
    });
    model_.grips.for_each([&](std::uint32_t, const Grip& g) { add_hand(g); });
    return load_;
  }

 private:
  /// Where the scheme takes forces: at the end of the step, or half way, x = x1 - h (v0 + v1) / 4.
  Vec3 place(std::uint32_t p) const {
    const Ring& r = model_.rings[model_.particles[p].ring];
    return r.position - back_ * (r.velocity - back_ * r.acceleration);
  }
  void add(const Vec3& at, const Vec3& force) {
    load_.force += force;
    load_.torque += cross(at - center_, force);
  }

  void add_forces_on(std::uint32_t p) {
    const Particle& particle = model_.particles[p];
    const Ring& ring = model_.rings[particle.ring];
    // Velocities have fallen by exp(-c h).
    const double h = model_.last_dt, c = model_.damping + model_.bodies[body_].damping;
    const double drag = h > 0 ? std::expm1(c * h) / h : 0;
    Vec3 force = particle.mass * (model_.acting_gravity() - drag * ring.velocity);
    force += calc_hinge_force(model_, p) + applied_to(model_, p);
    model_.for_each_bond_of(p, [&](std::uint32_t b) {
      if (model_.bonds[b].ties()) force += (model_.bonds[b].p == p ? -1 : 1) * model_.bond_force(b);
    });
    model_.for_each_constraint_of(p, [&](std::uint32_t c, int at) { force += ingredient::calc_force_at(model_, c, at); });
    add(place(p), force);
  }

  void add_hand(const Grip& g) {
    if (g.body != body_) return;
    Vec3 at;
    for (std::uint32_t i = 0; i < g.count; ++i) at += g.weights[i] * place(g.points[i]);
    if (model_.part_at(body_, at) == part_) add(at, g.force);
  }

  const Model& model_;
  std::uint32_t body_;
  BodyId part_;
  double back_;
  Vec3 center_;
  OutsideLoad load_;
};

}  // namespace

OutsideLoad calc_outside_load(const Model& model, std::uint32_t body, BodyId part) {
  return PartBalance(model, body, part).load();
}

}  // namespace iota::step
