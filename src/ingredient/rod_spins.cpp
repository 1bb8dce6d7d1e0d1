// SPDX-License-Identifier: Apache-2.0
#include "ingredient/rod_spins.h"

#include "ingredient/model.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace iota::ingredient {

namespace {

/// In the unit of the solver's force, kg m/s.
double spin_of(const Model& model, std::uint32_t body) {
  return model.spins.at(body).momentum / model.bodies[body].first_row.length;
}
/// The share of a momentum that half of the damping of a step leaves: the solver's step is between the two halves.
double left_of_half(const Model& model, std::uint32_t body, double h) {
  constexpr double most = 300;  // of more nothing is left, and readings divide by it
  return std::exp(-std::min((model.damping + model.body_damping[body]) * h / 2, most));
}

}  // namespace

void RodSpins::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.spins.is_empty()) return;
  for (const std::uint32_t body : map.bodies) {
    if (!model.spins.has(body)) continue;
    const model::InertiaPair& pair = model.inertia_pairs[model.bodies[body].first_inertia];
    solver::GyroscopicForce force;
    force.arm.nodes = {map.node_of(pair.p), map.node_of(pair.q)};
    force.arm.weights = {-1, 1};
    force.arm.count = 2;
    problem.add(force, {owner, {}, body});
  }
}

void RodSpins::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  const std::span forces = problem.items_of<solver::GyroscopicForce>();
  for_each_item_of<solver::GyroscopicForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    forces[i].spin = left_of_half(model, key.slot, h) * spin_of(model, key.slot);
  });
}

double RodSpins::after_step(Model& model, double h, Problem& problem) {
  double lost = 0;
  for_each_item_of<solver::GyroscopicForce>(owner, problem, [&](std::size_t, solver::ItemKey key) {
    RodSpin& spin = model.spins.at(key.slot);
    const double left = left_of_half(model, key.slot, h);
    lost += energy(model, key.slot);
    spin.momentum *= left;
    spin.angle += h * spin.momentum / model.axial_inertia(key.slot);
    spin.momentum *= left;
    lost -= energy(model, key.slot);
  });
  return lost;
}

void RodSpins::put_to_rest(Model& model, const Problem& problem) const {
  for_each_item_of<solver::GyroscopicForce>(
      owner, problem, [&](std::size_t, solver::ItemKey key) { model.spins.at(key.slot).momentum = 0; });
}

void RodSpins::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a spin", model.spins, model.bodies);
  model.spins.for_each([&](std::uint32_t slot, const RodSpin& spin) {
    audit.require(!model.bodies.is_alive(slot) || model.axial_inertia(slot) > 0, "body ", slot,
                  " spins, but is not a rod");
    audit.require(std::isfinite(spin.momentum) && std::isfinite(spin.angle), "the spin of ", slot, " is not finite");
  });
}

double RodSpins::energy(const Model& model, std::uint32_t body) {
  const double momentum = model.spins.at(body).momentum;
  return 0.5 * momentum * momentum / model.axial_inertia(body);
}

void RodSpins::add_energy(const Scope& scope, Energies& sum) {
  scope.for_each_body_in(scope.model.spins, [&](std::uint32_t body) { sum.kinetic += energy(scope.model, body); });
}

void RodSpins::add_momentum(const Scope& scope, Momenta& sum) {
  scope.for_each_body_in(scope.model.spins,
                         [&](std::uint32_t body) { sum.angular += inner_momentum(scope.model, body); });
}

// An inertial force: the momentum of the spin turns with the axis.
void RodSpins::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (!model.spins.has(body) || !(step.h() > 0)) return;
  const model::InertiaPair& pair = model.inertia_pairs[model.bodies[body].first_inertia];
  const solver::GyroscopicForce gyroscopic{.spin = spin_of(model, body) / left_of_half(model, body, step.h())};
  const Vec3 on_q =
      gyroscopic.force(step.start(pair.q) - step.start(pair.p), step.end(pair.q) - step.end(pair.p), step.stage);
  const BodyId part = model.particles[pair.p].part;
  reader.take({.particle = pair.p, .force = -on_q, .kind = Load::Kind::inertia, .part = part});
  reader.take({.particle = pair.q, .force = on_q, .kind = Load::Kind::inertia, .part = part});
}

void RodSpins::set(Model& model, std::uint32_t body, double angular_velocity) {
  if (model.spins.has(body) != (angular_velocity != 0)) model.mark_body(body);
  if (angular_velocity == 0)
    model.spins.erase(body);
  else
    model.spins.make(body).momentum = model.axial_inertia(body) * angular_velocity;
}

void RodSpins::forget_body(Model& model, std::uint32_t body) { model.spins.erase(body); }

void RodSpins::inertia_changed(Model& model, std::uint32_t body) {
  if (model.spins.has(body) && !(model.axial_inertia(body) > 0)) model.spins.erase(body);  // no longer a rod
}

Vec3 RodSpins::inner_momentum(const Model& model, std::uint32_t body) {
  return model.spins.has(body) ? model.spins.at(body).momentum * model.rod_axis(body) : Vec3{};
}

}  // namespace iota::ingredient
