// SPDX-License-Identifier: Apache-2.0
#include "ingredient/grips.h"

#include <algorithm>
#include <numbers>

namespace iota::ingredient {

void Grips::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  double total_mass = -1;  // of the bodies that can move; taken when there is a grip
  const auto calc_total_mass = [&] {
    double sum = 0;
    for (const std::uint32_t body : map.nodes.bodies)
      if (is_free(model.bodies[body].kind)) sum += model.body_mass(body);
    return sum;
  };
  model.grips.for_each([&](std::uint32_t slot, const model::Grip& g) {
    if (!is_free(model.bodies[g.body].kind)) return;
    solver::GripForce force;
    for (std::uint32_t i = 0; i < g.count; ++i) {
      const std::uint32_t node = map.node_of(g.points[i]);
      if (node == none) return;  // of another island
      force.arm.nodes[i] = node, force.arm.weights[i] = g.weights[i];
    }
    force.arm.count = g.count;
    forces_in<solver::GripForce>(problem).push_back(force);
    slots_.push_back(slot);
    // A grip feels the body that it holds and, through the hinges, part of what hangs on that: enough to lift it all.
    if (total_mass < 0) total_mass = calc_total_mass();
    const double own = model.body_mass(g.body);
    masses_.push_back(own + 0.5 * (total_mass - own));
  });
  arms_.resize(slots_.size());
}

void Grips::load(const Model& model, const IslandNodes&, double, Problem& problem) {
  auto& forces = forces_in<solver::GripForce>(problem);
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const model::Grip& g = model.grips[slots_[i]];
    const double omega = 2 * std::numbers::pi * g.frequency;
    forces[i].arm.origin = g.target;
    arms_[i] = forces[i].arm.value(problem.position.data());
    // The stiffness gives the largest force at this distance where the body is far away.
    const double distance = norm(arms_[i]);
    forces[i].stiffness = masses_[i] * std::min(omega * omega, g.max_acceleration / (distance + 1e-12));
    forces[i].damping = 2 * masses_[i] * omega;
  }
}

// Means over the step, taken where the scheme takes forces and before velocities are damped.
void Grips::store(Model& model, const IslandNodes&, double h, const Problem& problem) const {
  const auto& forces = forces_in<solver::GripForce>(problem);
  for (std::size_t i = 0; i < slots_.size(); ++i)
    model.grips[slots_[i]].force = forces[i].force(arms_[i], forces[i].arm.value(problem.position.data()),
                                                   {.h = h, .midpoint = !model.steps_to_end_point()});
}

void Grips::validate(const Model& model, model::Audit& audit) {
  model.grips.for_each([&](std::uint32_t slot, const model::Grip& g) {
    audit.require(model.bodies.is_alive(g.body), "grip ", slot, " holds no living body");
    for (std::uint32_t i = 0; i < g.count; ++i)
      audit.require(model.particles.is_alive(g.points[i]) && model.particles[g.points[i]].body == g.body, "grip ", slot,
                    " hangs on a stranger");
  });
}

// It counts for the part at the place that it holds, whichever points carry that.
void Grips::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  model.grips.for_each([&](std::uint32_t, const model::Grip& g) {
    if (g.body != body) return;
    Vec3 place;
    for (std::uint32_t i = 0; i < g.count; ++i) place += g.weights[i] * step.place(g.points[i]);
    const BodyId part = model.part_at(body, place);
    for (std::uint32_t i = 0; i < g.count; ++i)
      reader.take({.particle = g.points[i], .force = g.weights[i] * g.force, .part = part});
  });
}

bool Grips::holds(const Model& model, std::uint32_t particle) {
  bool any = false;
  model.grips.for_each(
      [&](std::uint32_t, const model::Grip& g) { any = any || g.body == model.particles[particle].body; });
  return any;
}

}  // namespace iota::ingredient
