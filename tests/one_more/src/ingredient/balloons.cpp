// SPDX-License-Identifier: Apache-2.0
#include "ingredient/balloons.h"

#include "ingredient/model.h"
#include "math/checks.h"

namespace iota::ingredient {

namespace {

/// visit(balloon): of each balloon at a particle.
template <class Visit>
void for_each_at(const Model& model, std::uint32_t particle, Visit visit) {
  model.balloons.for_each_of(particle, [&](std::uint32_t slot) { visit(model.balloons[slot]); });
}

void pop(Model& model, std::uint32_t slot) {
  const std::uint32_t particle = model.balloons[slot].at(0);
  --model.particles[particle].uses;
  model.touch_particle(particle);
  model.balloons.destroy(slot);
}

}  // namespace

Id<"balloon"> Balloons::apply(Model& model, const CreateBalloon& c) {
  const std::uint32_t particle = require(model, c.particle);
  require_finite("lift", c.lift);
  Balloon balloon;
  balloon.particles = {particle}, balloon.lift = c.lift;
  ++model.structure_version, ++model.particles[particle].uses;
  model.touch_particle(particle);
  return model.balloons.id(model.balloons.create(balloon));
}

void Balloons::apply(Model& model, const SetLift& c) {
  Balloon& balloon = model.balloons[require(model, c.balloon)];
  require_finite("lift", c.lift);
  balloon.lift = c.lift;
  model.touch_particle(balloon.at(0));
}

void Balloons::apply(Model& model, const Destroy<Id<"balloon">>& c) {
  pop(model, require(model, c.id));
  ++model.structure_version;
}

void Balloons::check_links(const Model& model, model::Audit& audit) { audit.check_ends("balloon", model.balloons); }

void Balloons::validate(const Model& model, model::Audit& audit) {
  model.balloons.for_each([&](std::uint32_t slot, const Balloon& balloon) {
    audit.require_ends("balloon", slot, balloon);
    audit.use_particle(balloon.at(0));
  });
  audit.require_listed("balloon", model.balloons);
}

void Balloons::add_energy(const Scope& scope, Energies& sum) {
  scope.for_each_particle([&](std::uint32_t p, const model::Particle&) {
    for_each_at(scope.model, p, [&](const Balloon& b) { sum.potential -= dot(b.lift, scope.model.position(p)); });
  });
}

void Balloons::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  step.model.for_each_particle_of(body, [&](std::uint32_t p) {
    for_each_at(step.model, p, [&](const Balloon& b) {
      reader.take({.particle = p, .force = b.lift, .part = step.model.particles[p].part});
    });
  });
}

bool Balloons::holds(const Model& model, std::uint32_t particle) { return model.balloons.ends_at(particle); }

void Balloons::absorb(Model& model, std::uint32_t q, std::uint32_t p) {
  const auto moved = [&](std::uint32_t) { --model.particles[q].uses, ++model.particles[p].uses; };
  model.balloons.redirect(q, p, moved, [&](std::uint32_t slot) { pop(model, slot); });
}

void Balloons::drop(Model& model, std::uint32_t particle) {
  model.balloons.for_each_of(particle, [&](std::uint32_t slot) { pop(model, slot); });
}

void Balloons::load(const Model& model, const IslandNodes& nodes, double, Problem& problem) {
  if (model.balloons.size() == 0) return;
  problem.force.resize(problem.size());
  for (std::uint32_t node = 0; node < nodes.size(); ++node)
    model.for_each_in_ring(nodes.rings[node], [&](std::uint32_t p) {
      for_each_at(model, p, [&](const Balloon& b) { problem.force[node] += b.lift; });
    });
}

}  // namespace iota::ingredient
