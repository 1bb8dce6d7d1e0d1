// SPDX-License-Identifier: Apache-2.0
#include "ingredient/balloons.h"

#include "ingredient/model.h"

namespace iota::ingredient {

namespace {

/// The balloon of a particle's ring; null for the other particles of that ring, so that it counts once.
const Balloon* balloon_of(const Model& model, std::uint32_t particle) {
  const std::uint32_t ring = model.particles[particle].ring;
  return model.rings[ring].first == particle ? model.balloons.find(ring) : nullptr;
}

}  // namespace

void Balloons::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a balloon", model.balloons, model.rings);
}

void Balloons::add_energy(const Scope& scope, Energies& sum) {
  scope.for_each_particle([&](std::uint32_t p, const model::Particle& particle) {
    if (const Balloon* const balloon = balloon_of(scope.model, p))
      sum.potential -= dot(balloon->lift, scope.model.rings[particle.ring].position);
  });
}

void Balloons::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  step.model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (const Balloon* const balloon = balloon_of(step.model, p))
      reader.take({.particle = p, .force = balloon->lift, .part = step.model.particles[p].part});
  });
}

bool Balloons::holds(const Model& model, std::uint32_t particle) {
  return model.balloons.find(model.particles[particle].ring) != nullptr;
}

void Balloons::ring_changed(Model& model, std::uint32_t ring) {
  if (model.rings[ring].count == 0) model.balloons.erase(ring);
}

void Balloons::ring_merged(Model& model, std::uint32_t into, std::uint32_t from, bool) {
  if (const Vec3 lift = model.balloons[from].lift; lift != Vec3{}) model.balloons.make(into).lift += lift;
}

void Balloons::load(const Model& model, const IslandNodes& nodes, double, Problem& problem) {
  if (model.balloons.is_empty()) return;
  problem.force.resize(problem.size());
  for (std::uint32_t node = 0; node < nodes.size(); ++node)
    problem.force[node] += model.balloons[nodes.rings[node]].lift;
}

}  // namespace iota::ingredient
