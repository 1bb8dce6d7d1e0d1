// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pushes.h"

#include <algorithm>
#include <utility>

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
    if (model::Push* const push = model.pushes.find(ring)) push->before = std::exchange(push->force, Vec3{});
  });
}

bool Pushes::wakes(const Model& model, const IslandNodes& nodes) const {
  if (model.pushes.is_empty()) return false;
  bool any = false;
  nodes.for_each_ring(model, [&](std::uint32_t ring) { any = any || model.pushes[ring].force != Vec3{}; });
  return any;
}

bool Pushes::keeps_awake(const Problem& problem) const {
  return std::any_of(problem.force.begin(), problem.force.end(), [](const Vec3& f) { return f != Vec3{}; });
}

}  // namespace iota::ingredient
