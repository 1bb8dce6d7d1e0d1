// SPDX-License-Identifier: Apache-2.0
#include "ingredient/oriented_particles.h"

#include "ingredient/model.h"
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

}  // namespace iota::ingredient
