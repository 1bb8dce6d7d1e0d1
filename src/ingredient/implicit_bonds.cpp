// SPDX-License-Identifier: Apache-2.0
#include "ingredient/implicit_bonds.h"

#include <algorithm>

namespace iota::ingredient {

void ImplicitBonds::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.bonds.size() == 0) return;
  std::vector<std::uint32_t> bonds;  // each once, in order of slots
  for (const std::uint32_t body : map.nodes.bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.for_each_bond_of(p, [&](std::uint32_t b) {
        if (model.bonds[b].p == p && model.bonds[b].ties()) bonds.push_back(b);
      });
    });
  std::sort(bonds.begin(), bonds.end());
  for (const std::uint32_t slot : bonds) {
    const model::Bond& b = model.bonds[slot];
    solver::ForceArm arm;
    arm.nodes = {map.node_of(b.p), map.node_of(b.q)};
    arm.weights = {-1, 1};
    arm.count = 2;
    if (arm.nodes[0] == none || arm.nodes[1] == none || arm.nodes[0] == arm.nodes[1]) continue;
    if (b.law == model::spring_law) {
      forces_in<solver::SpringForce>(problem).push_back({arm});
      springs_.push_back(slot);
    } else if (b.law == model::drag_law) {
      forces_in<solver::DragForce>(problem).push_back({arm});
      drags_.push_back(slot);
    } else {
      solver::RadialForce force{arm, &model.compiled(b.law)};
      force.m_p = model.particles[b.p].mass, force.m_q = model.particles[b.q].mass;
      forces_in<solver::RadialForce>(problem).push_back(force);
      radials_.push_back(slot);
    }
  }
}

void ImplicitBonds::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  auto& springs = forces_in<solver::SpringForce>(problem);
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const auto& p = model.bonds[springs_[i]].parameters;
    springs[i].stiffness = p[0], springs[i].damping = p[1], springs[i].length = p[2];
  }
  auto& drags = forces_in<solver::DragForce>(problem);
  for (std::size_t i = 0; i < drags_.size(); ++i) drags[i].damping = model.bonds[drags_[i]].parameters[0];
  auto& radials = forces_in<solver::RadialForce>(problem);
  for (std::size_t i = 0; i < radials_.size(); ++i) {
    radials[i].parameters = model.bonds[radials_[i]].parameters;
    radials[i].time = model.time + h;  // a law that changes with time is taken at the end of the step
  }
}

}  // namespace iota::ingredient
