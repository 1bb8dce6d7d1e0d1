// SPDX-License-Identifier: Apache-2.0
#include "ingredient/bonds.h"

#include <algorithm>
#include <cmath>

namespace iota::ingredient {

void Bonds::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.bonds.size() == 0) return;
  std::vector<std::uint32_t> bonds;
  for (const std::uint32_t body : map.bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.for_each_bond_of(p, [&](std::uint32_t b) {
        if (model.bonds[b].ties()) bonds.push_back(b);
      });
    });
  sort_unique(bonds);
  for (const std::uint32_t slot : bonds) {
    const model::Bond& b = model.bonds[slot];
    solver::ForceArm arm;
    arm.nodes = {map.node_of(b.p), map.node_of(b.q)};
    arm.weights = {-1, 1};
    arm.count = 2;
    if (arm.nodes[0] == none || arm.nodes[1] == none || arm.nodes[0] == arm.nodes[1]) continue;
    const solver::ItemKey key{owner, {}, slot};
    if (b.law == model::spring_law) {
      problem.add(solver::SpringForce{arm}, key);
    } else if (b.law == model::drag_law) {
      problem.add(solver::DragForce{arm}, key);
    } else {
      solver::RadialForce force{arm, &model.compiled(b.law)};
      force.m_p = model.particles[b.p].mass, force.m_q = model.particles[b.q].mass;
      problem.add(force, key);
    }
  }
}

void Bonds::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  const auto for_each = [&]<class Force>(auto load) {
    auto& forces = problem.pool_of<Force>().items;
    for_each_item_of<Force>(
        owner, problem, [&](std::size_t i, solver::ItemKey key) { load(forces[i], model.bonds[key.slot].parameters); });
  };
  for_each.operator()<solver::SpringForce>([](solver::SpringForce& spring, const auto& p) {
    spring.stiffness = p[0], spring.damping = p[1], spring.length = p[2];
  });
  for_each.operator()<solver::DragForce>([](solver::DragForce& drag, const auto& p) { drag.damping = p[0]; });
  for_each.operator()<solver::RadialForce>([&](solver::RadialForce& radial, const auto& p) {
    radial.parameters = p;
    radial.time = model.time + h;  // a law that changes with time is taken at the end of the step
  });
}

void Bonds::validate(const Model& model, model::Audit& audit) {
  model.bonds.for_each([&](std::uint32_t slot, const model::Bond& b) {
    audit.require_ends("bond", slot, b);
    audit.use_particle(b.p), audit.use_particle(b.q);
    audit.use_law("bond", slot, b.law);
    if (model.laws.is_alive(b.law))
      audit.require(!b.implicit || model.laws[b.law].has_derivative(), "bond ", slot,
                    " is implicit without a derivative");
    for (const double v : b.parameters)
      audit.require(std::isfinite(v), "bond ", slot, " has a parameter that is not finite");
  });
  audit.require_listed("bond", model.bonds, &model::References::first_bond);
}

laws::PairState Bonds::state(const Model& model, const model::Bond& b, double ahead) {
  const model::Ring &p = model.rings[model.particles[b.p].ring], &q = model.rings[model.particles[b.q].ring];
  const Vec3 u = q.velocity - p.velocity, d = q.position - p.position + ahead * u;
  const double r = norm(d);
  return {r, dot(d, u) / (r + 1e-300), model.time, model.particles[b.p].mass, model.particles[b.q].mass};
}

double Bonds::energy(const Model& model, std::uint32_t slot) {
  const model::Bond& b = model.bonds[slot];
  if (!b.ties()) return 0;
  // An infinite one, of ends that have met for instance, counts for nothing; the next step switches the bond off.
  const double energy = model.compiled(b.law).elastic(state(model, b), b.parameters.data()).energy;
  return std::isfinite(energy) ? energy : 0;
}

Vec3 Bonds::force(const Model& model, std::uint32_t slot) {
  const model::Bond& b = model.bonds[slot];
  const laws::PairLaw& law = model.compiled(b.law);
  const laws::PairState ends = state(model, b);
  const Vec3 d = model.position(b.q) - model.position(b.p), u = model.velocity(b.q) - model.velocity(b.p);
  const double* const parameters = b.parameters.data();
  double along = -law.elastic(ends, parameters).slope;
  if (law.has_push()) along += law.push(ends, parameters).value;
  if (law.has_damping()) along += law.damping(ends, parameters).value;
  const double drag = law.has_drag() ? law.drag(ends, parameters) : 0;
  return (along / (ends.r + 1e-300)) * d - drag * u;
}

void Bonds::add_energy(const Scope& scope, Energies& sum) {
  const Model& model = scope.model;
  if (scope.is_whole())
    model.bonds.for_each([&](std::uint32_t slot, const model::Bond&) { sum.potential += energy(model, slot); });
  else if (model.bonds.size() > 0)
    scope.for_each_particle([&](std::uint32_t p, const model::Particle&) {
      model.for_each_bond_of(p, [&](std::uint32_t b) {
        if (model.bonds[b].p == p) sum.potential += energy(model, b);
      });
    });
}

void Bonds::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.for_each_bond_of(p, [&](std::uint32_t slot) {
      const model::Bond& bond = model.bonds[slot];
      if (!bond.ties()) return;  // forces that are held are applied as pushes
      const Vec3 on_q = force(model, slot);
      reader.take({.particle = p, .force = bond.p == p ? -on_q : on_q, .part = model.particles[p].part});
    });
  });
}

bool Bonds::holds(const Model& model, std::uint32_t particle) {
  bool any = false;
  model.for_each_bond_of(particle, [&](std::uint32_t b) { any = any || model.bonds[b].ties(); });
  return any;
}

}  // namespace iota::ingredient
