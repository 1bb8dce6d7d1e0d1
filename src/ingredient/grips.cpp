// SPDX-License-Identifier: Apache-2.0
#include "ingredient/grips.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace iota::ingredient {

namespace {

/// Of the bodies that can move and that rings, bonds and joints tie to a body, kg.
double calc_tied_mass(const Model& model, std::uint32_t body) {
  std::vector<std::uint32_t> articulates;
  for (const std::uint32_t b : model.tied_bodies(std::array{body})) articulates.push_back(model.bodies[b].articulate);
  sort_unique(articulates);
  double mass = 0;
  for (const std::uint32_t articulate : articulates)
    model.for_each_body_of(articulate, [&](std::uint32_t b) {
      if (is_free(model.bodies[b].kind)) mass += model.body_mass(b);
    });
  return mass;
}

}  // namespace

void Grips::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  model.grips.for_each([&](std::uint32_t slot, const model::Grip& g) {
    if (!is_free(model.bodies[g.body].kind)) return;
    solver::GripForce force;
    for (std::uint32_t i = 0; i < g.count; ++i) {
      const std::uint32_t node = map.node_of(g.points[i]);
      if (node == none) return;  // of another island
      force.arm.nodes[i] = node, force.arm.weights[i] = g.weights[i];
    }
    force.arm.count = g.count;
    problem.add(force, {owner, {}, slot});
    // A grip feels the body that it holds and, through the hinges, part of what hangs on that: enough to lift it all.
    const double own = model.body_mass(g.body);
    felt_masses_.push_back({slot, own + 0.5 * (calc_tied_mass(model, g.body) - own)});
  });
}

double Grips::felt_mass(std::uint32_t grip) const {
  return std::find_if(felt_masses_.begin(), felt_masses_.end(), [&](const auto& felt) { return felt.first == grip; })
      ->second;
}

void Grips::load(const Model& model, const IslandNodes&, double, Problem& problem) {
  auto& forces = problem.pool_of<solver::GripForce>().items;
  arms_.resize(forces.size());
  for_each_item_of<solver::GripForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const model::Grip& g = model.grips[key.slot];
    const double omega = 2 * std::numbers::pi * g.frequency, mass = felt_mass(key.slot);
    forces[i].arm.origin = g.target;
    arms_[i] = forces[i].arm.value(problem.position.data());
    // The stiffness gives the largest force at this distance where the body is far away.
    const double distance = norm(arms_[i]);
    forces[i].stiffness = mass * std::min(omega * omega, g.max_acceleration / (distance + 1e-12));
    forces[i].damping = 2 * mass * omega;
  });
}

// Means over the step, taken where the scheme takes forces and before velocities are damped.
void Grips::store(Model& model, const IslandNodes&, double h, const Problem& problem) const {
  const auto& forces = problem.pool_of<solver::GripForce>().items;
  for_each_item_of<solver::GripForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    model.grips[key.slot].force = forces[i].force(arms_[i], forces[i].arm.value(problem.position.data()),
                                                  {.h = h, .midpoint = !model.steps_to_end_point()});
  });
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
