// SPDX-License-Identifier: Apache-2.0
#include "ingredient/oriented_particles.h"

#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "math/mat3.h"

#include <cmath>

namespace iota::ingredient {

namespace {

template <class Visit>
void for_each_ball(const Scope& scope, Visit visit) {
  const Model& model = scope.model;
  if (model.attributes.size() == 0) return;
  if (scope.is_whole())
    model.attributes.for_each([&](std::uint32_t, const model::Attributes& a) {
      if (a.oriented && scope.is_active(model.particles[a.particle].body)) visit(a);
    });
  else
    scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
      if (p.attributes != none && model.attributes[p.attributes].oriented) visit(model.attributes[p.attributes]);
    });
}

// Free spin is exact: angular velocity is constant, and the rotation is by its length. The torque towards a direction
// is linearly implicit, so that any stiffness is stable.
void turn(Model& model, model::Attributes& a, double h) {
  const model::Particle& p = model.particles[a.particle];
  if (model.bodies[p.body].kind == BodyKind::inactive) return;
  const auto energy = [&] { return 0.5 * a.moment * dot(a.spin, a.spin); };
  const double damping = model.damping + a.damping;
  const auto damp = [&](double time) {
    if (!(damping > 0)) return;
    const double start = energy();
    a.spin *= std::exp(-damping * time);
    model.dissipated += start - energy();
  };
  damp(h / 2);
  const double before = energy();
  const Vec3 old = a.spin;
  Vec3 impulse = h * a.torque;
  double divisor = 1;
  if (a.stiffness > 0 || a.alignment_damping > 0) {
    const Vec3 normal = rotate(a.orientation, {0, 0, 1});
    impulse += (h * a.stiffness) * cross(normal, a.preferred);
    divisor += h * (a.alignment_damping + h * a.stiffness) / a.moment;
  }
  a.spin = (1 / divisor) * (a.spin + (1 / a.moment) * impulse);
  a.orientation = normalized(multiply(turn_by((h / 2) * (old + a.spin)), a.orientation));
  a.torque = {};
  model.external_work += energy() - before;
  damp(h / 2);
}

}  // namespace

void OrientedParticles::validate(const Model& model, model::Audit& audit) {
  model.attributes.for_each([&](std::uint32_t slot, const model::Attributes& a) {
    audit.require(model.particles.is_alive(a.particle) && model.particles[a.particle].attributes == slot, "attributes ",
                  slot, " are of no living particle");
  });
}

void OrientedParticles::add_energy(const Scope& scope, Energies& sum) {
  for_each_ball(scope,
                [&](const model::Attributes& ball) { sum.kinetic += 0.5 * ball.moment * dot(ball.spin, ball.spin); });
}

void OrientedParticles::add_momentum(const Scope& scope, Momenta& sum) {
  for_each_ball(scope, [&](const model::Attributes& ball) { sum.angular += ball.moment * ball.spin; });
}

void OrientedParticles::end_step(Model& model, double h) {
  model.attributes.for_each([&](std::uint32_t, model::Attributes& a) {
    a.age += h;
    if (a.oriented) turn(model, a, h);
  });
}

void OrientedParticles::tell(Model& model, Outcome& outcome) {
  model.attributes.for_each([&](std::uint32_t, const model::Attributes& a) {
    if (a.age >= a.lifetime) outcome.ended.push_back(model.particles.id(a.particle));
  });
}

}  // namespace iota::ingredient
