// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pushes.h"

#include <algorithm>
#include <utility>
#include "ingredient/model.h"

namespace iota::ingredient {

void Pushes::load(const Model& model, const IslandNodes& nodes, double, Problem& problem) {
  problem.force.clear();
  if (model.pushes.is_empty()) return;
  const auto add = [&](std::uint32_t node, const Vec3& force) {
    if (force == Vec3{}) return;
    if (problem.force.empty()) problem.force.resize(problem.size());
    problem.force[node] += force;
  };
  for (std::uint32_t node = 0; node < nodes.size(); ++node) add(node, model.pushes[nodes.rings[node]].force);
  for (std::size_t i = 0; i < nodes.carried.size(); ++i) {  // a force on a carried particle acts through the basis
    const Vec3& force = model.pushes[model.particles[nodes.carried[i]].ring].force;
    for (const auto& [node, weight] : nodes.carriers[i])
      if (weight != 0) add(node, weight * force);
  }
}

void Pushes::store(Model& model, const IslandNodes& nodes, double, const Problem&) const {
  if (model.pushes.is_empty()) return;
  nodes.for_each_ring(model, [&](std::uint32_t ring) {
    if (Push* const push = model.pushes.find(ring)) push->before = std::exchange(push->force, Vec3{});
  });
}

void Pushes::visit_stirred(const Model& model, double, Visit visit) {
  model.pushes.for_each([&](std::uint32_t ring, const Push& push) {
    if (push.force != Vec3{}) visit(ring);
  });
}

bool Pushes::keeps_awake(const Model&, const Problem& problem) const {
  return std::any_of(problem.force.begin(), problem.force.end(), [](const Vec3& f) { return f != Vec3{}; });
}

void Pushes::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a push", model.pushes, model.rings);
}

// A force on a shared place is distributed equally over its movable bodies.
void Pushes::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (model.pushes.is_empty()) return;
  const bool moves = is_free(model.bodies[body].kind);
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const model::Particle& particle = model.particles[p];
    const Push* const push = model.pushes.find(particle.ring);
    if (!push) return;
    int free = 0;
    model.for_each_in_ring(
        particle.ring, [&](std::uint32_t other) { free += is_free(model.bodies[model.particles[other].body].kind); });
    if (!moves && free > 0) return;
    reader.take({.particle = p, .force = (1.0 / std::max(1, free)) * push->before, .part = particle.part});
  });
}

// Forces act for one step, also on points that cannot move: otherwise they would act when such a body becomes dynamic.
void Pushes::end_step(Model& model, double) {
  model.pushes.for_each([&](std::uint32_t ring, const Push& push) {
    if (push.force == Vec3{}) return;
    bool all_free = true;
    model.for_each_in_ring(
        ring, [&](std::uint32_t p) { all_free = all_free && is_free(model.bodies[model.particles[p].body].kind); });
    if (!all_free) model.pushes.at(ring).force = {};
  });
}

void Pushes::ring_changed(Model& model, std::uint32_t ring) {
  if (model.rings[ring].count == 0) model.pushes.erase(ring);
}

void Pushes::ring_merged(Model& model, std::uint32_t into, std::uint32_t from, bool) {
  if (const Vec3 force = model.pushes[from].force; force != Vec3{}) model.pushes.make(into).force += force;
}

}  // namespace iota::ingredient
