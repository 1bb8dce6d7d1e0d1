// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pushes.h"

#include <algorithm>
#include <utility>
#include "ingredient/model.h"
#include "ingredient/noise.h"
#include "math/mat3.h"
#include "math/text.h"

namespace iota::ingredient {

namespace {

/// visit(particle, force): forces on the massive particles of a body that add up to a torque, in proportion to its angular
/// acceleration, m (a x r), so that there is no load within it. place(particle): where it is. Returns what they add up to.
template <class Place, class Visit>
Vec3 spread_torque(const Model& model, std::uint32_t body, const Vec3& torque, Place place, Visit visit) {
  const auto each = [&](auto look) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (!model.particles[p].is_marker()) look(p, model.particles[p].mass);
    });
  };
  double mass = 0;
  Vec3 center;
  each([&](std::uint32_t p, double m) { mass += m, center += m * place(p); });
  center *= 1 / (mass + 1e-300);
  Mat3 inertia;
  each([&](std::uint32_t p, double m) { inertia += point_inertia(m, place(p) - center); });
  const Vec3 turn = solve_semidefinite(inertia, torque);
  each([&](std::uint32_t p, double m) { visit(p, m * cross(turn, place(p) - center)); });
  return inertia * turn;
}

}  // namespace

void Pushes::check_torque(const Model& model, std::uint32_t body, const Vec3& torque) {
  constexpr double round_off = 1e-9;
  const Vec3 reached =
      spread_torque(model, body, torque, [&](std::uint32_t p) { return model.position(p); }, [](auto&&...) {});
  if (!(norm(reached - torque) <= round_off * norm(torque)))
    throw std::invalid_argument(
        text("a torque of ", text_of(torque), " N m cannot act on body ", body,
             ": its particles are at one place or on one line, about which nothing has a lever; a body given by shape "
             "can be turned"));
}

void Pushes::add_torque(Model& model, std::uint32_t body, const Vec3& torque) {
  if (torque != Vec3{}) model.torques.make(body).torque += torque;
}

void Pushes::forget_body(Model& model, std::uint32_t body) { model.torques.erase(body); }

// On the points of the basis, which are unknowns.
void Pushes::load_torques(const Model& model, const IslandNodes& nodes, Problem& problem) {
  problem.torques.clear();
  if (model.torques.is_empty()) return;
  thread_local std::vector<std::pair<std::uint32_t, std::uint32_t>> node_of_ring;  // made for the first torque
  node_of_ring.clear();
  for (const std::uint32_t body : nodes.bodies) {
    const Torque* const applied = model.torques.find(body);
    if (!applied || applied->torque == Vec3{} || !is_free(model.bodies[body].kind)) continue;
    if (node_of_ring.empty()) {
      for (std::uint32_t node = 0; node < nodes.size(); ++node) node_of_ring.push_back({nodes.rings[node], node});
      std::sort(node_of_ring.begin(), node_of_ring.end());
    }
    solver::BodyTorque& torque = problem.torques.emplace_back();
    torque.torque = applied->torque, torque.count = model.bodies[body].rank;
    for (std::uint32_t i = 0; i < torque.count; ++i) {
      const std::pair key{model.particles[model.bodies[body].basis[i]].ring, 0u};
      torque.nodes[i] = std::lower_bound(node_of_ring.begin(), node_of_ring.end(), key)->second;
    }
  }
}

void Pushes::load(const Model& model, const IslandNodes& nodes, double, Problem& problem) {
  problem.force.clear();
  load_torques(model, nodes, problem);
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
  load_parts_by_velocity(model, nodes, problem);
}

// They change from step to step, and couple only points of one body, which are coupled anyway.
void Pushes::load_parts_by_velocity(const Model& model, const IslandNodes& nodes, Problem& problem) {
  if (problem.has_used<solver::VelocityForce>()) {
    auto& pool = problem.pool_of<solver::VelocityForce>();
    pool.items.clear(), pool.keys.clear(), pool.slots.clear();
  }
  arms_.clear();
  if (model.pushes_by_velocity.is_empty()) return;
  const auto add = [&](std::uint32_t ring, const solver::ForceArm& arm) {
    const PushByVelocity* const part = model.pushes_by_velocity.find(ring);
    if (!part) return;
    solver::VelocityForce force;
    force.arm = arm, force.part = {part->rate, model.ring_mass(ring)};
    for (std::uint32_t i = 0; i < arm.count; ++i) problem.force[arm.nodes[i]] -= arm.weights[i] * part->force;
    problem.add(force, {owner, {}, ring});
    arms_.push_back(arm.value(problem.position.data()));
  };
  if (problem.force.empty()) problem.force.resize(problem.size());
  for (std::uint32_t node = 0; node < nodes.size(); ++node)
    add(nodes.rings[node], {.nodes = {node}, .weights = {1}, .count = 1});
  for (std::size_t i = 0; i < nodes.carried.size(); ++i) {
    solver::ForceArm arm;
    for (const auto& [node, weight] : nodes.carriers[i])
      if (weight != 0) arm.nodes[arm.count] = node, arm.weights[arm.count++] = weight;
    add(model.particles[nodes.carried[i]].ring, arm);
  }
}

// Pushes act on until `end_step`: an island may take the step in parts. Ended here, a brake that was pressed on a fast disc had a
// tenth of its force.
void Pushes::store(Model& model, const IslandNodes& nodes, double h, const Problem& problem) const {
  if (!model.torques.is_empty())
    for (const std::uint32_t body : nodes.bodies)
      if (Torque* const torque = model.torques.find(body)) torque->before = torque->torque;
  if (model.pushes.is_empty()) return;
  nodes.for_each_ring(model, [&](std::uint32_t ring) {
    if (Push* const push = model.pushes.find(ring)) push->before = push->force;
  });
  for_each_item_of<solver::VelocityForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    model.pushes.at(key.slot).before +=
        force_by_velocity(model, key.slot, h, problem, i) - model.pushes_by_velocity.at(key.slot).force;
  });
}

// At the time of the scheme's forces.
Vec3 Pushes::force_by_velocity(const Model& model, std::uint32_t ring, double h, const Problem& problem,
                               std::size_t item) const {
  const solver::VelocityForce& f = problem.items_of<solver::VelocityForce>()[item];
  if (model.rings[ring].is_instant) return f.part.at_an_instant(f.arm.rate(problem.velocity.data()));
  return f.force(arms_[item], f.arm.value(problem.position.data()), {.h = h, .midpoint = !model.steps_to_end_point()});
}

void Pushes::visit_stirred(const Model& model, double, Visit visit) {
  model.pushes.for_each([&](std::uint32_t ring, const Push& push) {
    if (!is_noise(model, push.force, model.ring_mass(ring))) visit(ring);
  });
  model.torques.for_each([&](std::uint32_t body, const Torque& torque) {
    if (torque.torque != Vec3{}) visit(model.particles[model.bodies[body].first].ring);
  });
}

bool Pushes::keeps_awake(const Model& model, const Problem& problem) const {
  if (!problem.torques.empty() || !problem.items_of<solver::VelocityForce>().empty()) return true;
  for (std::size_t i = 0; i < problem.force.size(); ++i)
    if (!is_noise(model, problem.force[i], problem.mass[i])) return true;
  return false;
}

void Pushes::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a push", model.pushes, model.rings);
  audit.require_owners("a torque", model.torques, model.bodies);
}

// A force on a shared place is distributed equally over its movable bodies.
void Pushes::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (const Torque* const torque = model.torques.find(body); torque && torque->before != Vec3{})
    spread_torque(
        model, body, torque->before, [&](std::uint32_t p) { return step.place(p); },
        [&](std::uint32_t p, const Vec3& force) {
          reader.take({.particle = p, .force = force, .part = model.particles[p].part});
        });
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
  model.pushes_by_velocity.clear();
  model.pushes.for_each([&](std::uint32_t ring, const Push& push) {
    if (push.force != Vec3{}) model.pushes.at(ring).force = {};
  });
  model.torques.for_each([&](std::uint32_t body, const Torque&) { model.torques.at(body).torque = {}; });
}

void Pushes::ring_changed(Model& model, std::uint32_t ring) {
  if (model.rings[ring].count == 0) model.pushes.erase(ring);
}

void Pushes::ring_merged(Model& model, std::uint32_t into, std::uint32_t from, bool) {
  if (const Vec3 force = model.pushes[from].force; force != Vec3{}) model.pushes.make(into).force += force;
}

}  // namespace iota::ingredient
