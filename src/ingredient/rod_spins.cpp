// SPDX-License-Identifier: Apache-2.0
#include "ingredient/rod_spins.h"

#include <cmath>

namespace iota::ingredient {

void RodSpins::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.spins.is_empty()) return;
  for (const std::uint32_t body : map.nodes.bodies) {
    if (!model.spins.has(body)) continue;
    const model::InertiaPair& pair = model.inertia_pairs[model.bodies[body].first_inertia];
    solver::GyroscopicForce force;
    force.arm.nodes = {map.node_of(pair.p), map.node_of(pair.q)};
    force.arm.weights = {-1, 1};
    force.arm.count = 2;
    forces_in<solver::GyroscopicForce>(problem).push_back(force);
    bodies_.push_back(body);
  }
}

void RodSpins::load(const Model& model, const IslandNodes&, double, Problem& problem) {
  auto& forces = forces_in<solver::GyroscopicForce>(problem);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    forces[i].spin = model.spins[bodies_[i]].momentum / model.bodies[bodies_[i]].first_row.length;
}

double RodSpins::after_step(Model& model, double h, Problem&) {
  double lost = 0;
  for (const std::uint32_t body : bodies_) {
    model::RodSpin& spin = model.spins.at(body);
    lost += model.spin_energy(body);
    spin.momentum *= std::exp(-(model.damping + model.bodies[body].damping) * h);
    lost -= model.spin_energy(body);
    spin.angle += h * spin.momentum / model.axial_inertia(body);
  }
  return lost;
}

void RodSpins::put_to_rest(Model& model) const {
  for (const std::uint32_t body : bodies_) model.spins.at(body).momentum = 0;
}

}  // namespace iota::ingredient
