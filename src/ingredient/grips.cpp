// SPDX-License-Identifier: Apache-2.0
#include "ingredient/grips.h"

#include "ingredient/model.h"
#include "math/mat3.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace iota::ingredient {

namespace {

/// The mass of the movable ones of some bodies, each of which is listed once, kg.
double calc_movable_mass(const Model& model, std::span<const std::uint32_t> bodies) {
  double mass = 0;
  for (const std::uint32_t body : bodies)
    if (is_free(model.bodies[body].kind)) mass += model.body_mass(body);
  return mass;
}

/// A grip's effective mass, kg: its body and, through the hinges, enough of the connected ones to lift all; and of what touches
/// these as much, but not more than a few times their own. With all of it a box of 50 g beside one of 400 kg was pulled
/// with the strength for that.
double calc_felt_mass(const Model& model, std::uint32_t body) {
  constexpr double part = 0.5, most_times = 4;
  const double own = model.body_mass(body);
  double connected = 0, touching = 0;
  if (model.has_ties()) {
    connected = calc_movable_mass(model, model.connected_bodies(std::array{body}));
    if (model.contacts.size() > 0) touching = calc_movable_mass(model, model.tied_bodies(std::array{body})) - connected;
  } else {  // a search through 10 000 links takes longer than a sum
    model.for_each_body_of(model.bodies[body].articulate,
                           [&](std::uint32_t b) { connected += calc_movable_mass(model, std::array{b}); });
  }
  return own + part * (connected - own) + std::min(part * touching, most_times * connected);
}

}  // namespace

void Grips::build(const IslandMap& map, Problem& problem) { add(map, map.bodies, problem); }

// All forces of this pool are grips.
void Grips::renew_pulls(const IslandMap& map, Problem& problem) {
  if (problem.has_used<solver::GripForce>()) {
    auto& pool = problem.pool_of<solver::GripForce>();
    pool.items.clear(), pool.keys.clear(), pool.slots.clear();
  }
  std::erase_if(felt_masses_, [&](const FeltMass& felt) {
    return !map.model.grips.is_alive(felt.grip) || map.model.grips[felt.grip].body != felt.body;
  });
  add(map, map.nodes.bodies, problem);
}

// In the order of slots. It takes the time of the bodies, or of all grips if they are fewer.
void Grips::add(const IslandMap& map, std::span<const std::uint32_t> bodies, Problem& problem) {
  const Model& model = map.model;
  if (model.grips.size() == 0) return;
  thread_local std::vector<std::uint32_t> slots;
  slots.clear();
  if (model.grips.size() < bodies.size())
    model.grips.for_each([&](std::uint32_t slot, const Grip& g) {
      if (map.nodes.has(model, g.body)) slots.push_back(slot);
    });
  else
    for (const std::uint32_t body : bodies)
      model.grips.for_each_of(body, [&](std::uint32_t slot, const Grip&) { slots.push_back(slot); });
  std::sort(slots.begin(), slots.end());
  for (const std::uint32_t slot : slots) {
    const Grip& g = model.grips[slot];
    // The nodes of another island may come and go meanwhile: islands are built in parallel.
    if (!is_free(model.bodies[g.body].kind)) continue;
    solver::GripForce force;
    force.arm.count = g.count;
    bool has_nodes = true;
    for (std::uint32_t i = 0; i < g.count; ++i) {
      force.arm.nodes[i] = map.node_of(g.points[i]), force.arm.weights[i] = g.weights[i];
      has_nodes = has_nodes && force.arm.nodes[i] != none;
    }
    if (has_nodes) problem.add(force, {owner, {}, slot});
  }
  for_each_item_of<solver::GripForce>(owner, problem, [&](std::size_t, solver::ItemKey key) {
    if (!model.grips.is_alive(key.slot)) return;  // it is being renewed
    const std::uint32_t body = model.grips[key.slot].body;
    if (!map.nodes.has(model, body) || find_felt_mass(key.slot, body)) return;
    felt_masses_.push_back({key.slot, body, calc_felt_mass(model, body)});
  });
}

const double* Grips::find_felt_mass(std::uint32_t grip, std::uint32_t body) const {
  const auto found = std::find_if(felt_masses_.begin(), felt_masses_.end(),
                                  [&](const FeltMass& felt) { return felt.grip == grip && felt.body == body; });
  return found == felt_masses_.end() ? nullptr : &found->mass;
}

double Grip::stiffness_at(double distance) const {
  const double omega = 2 * std::numbers::pi * frequency;
  return std::min(omega * omega, max_acceleration / (distance + 1e-12));
}

void Grips::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  const double ahead = model.steps_to_end_point() ? 0 : h / 2;
  const std::span forces = problem.items_of<solver::GripForce>();
  arms_.resize(forces.size());
  for_each_item_of<solver::GripForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Grip& g = model.grips[key.slot];
    const double mass = *find_felt_mass(key.slot, g.body);
    forces[i].arm.origin = g.target - problem.origin;
    arms_[i] = forces[i].arm.value(problem.position.data());
    // In the middle of a step by the mid-point rule.
    forces[i].stiffness = mass * g.stiffness_at(norm(arms_[i] + ahead * forces[i].arm.rate(problem.velocity.data())));
    forces[i].damping = 2 * mass * (2 * std::numbers::pi * g.frequency);
  });
}

// Means over the step, at the time of the scheme's forces and before damping.
void Grips::store(Model& model, const IslandNodes&, double h, const Problem& problem) const {
  const auto& forces = problem.pool_of<solver::GripForce>().items;
  for_each_item_of<solver::GripForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    model.grips[key.slot].force = forces[i].force(arms_[i], forces[i].arm.value(problem.position.data()),
                                                  {.h = h, .midpoint = !model.steps_to_end_point()});
  });
}

void Grips::check_links(const Model& model, model::Audit& audit) {
  model.grips.for_each([&](std::uint32_t slot, const Grip& g) {
    audit.require(model.bodies.is_alive(g.body), "grip ", slot, " holds no living body");
    audit.require(g.count >= 1 && g.count <= g.points.size(), "grip ", slot, " refers to ", g.count, " points");
    for (std::uint32_t i = 0; i < std::min<std::size_t>(g.count, g.points.size()); ++i)
      audit.require(model.particles.is_alive(g.points[i]), "grip ", slot, " refers to a particle that does not exist");
  });
}

void Grips::validate(const Model& model, model::Audit& audit) {
  model.grips.for_each([&](std::uint32_t slot, const Grip& g) {
    bool is_listed = false;
    model.grips.for_each_of(g.body, [&](std::uint32_t other, const Grip&) { is_listed = is_listed || other == slot; });
    audit.require(is_listed, "grip ", slot, " is not listed at its body");
    for (std::uint32_t i = 0; i < g.count; ++i)
      audit.require(model.particles[g.points[i]].body == g.body, "grip ", slot,
                    " refers to a particle of another body");
  });
}

// It counts for the part at the held place, whichever points carry that.
void Grips::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  model.grips.for_each_of(body, [&](std::uint32_t, const Grip& g) {
    Vec3 place;
    for (std::uint32_t i = 0; i < g.count; ++i) place += g.weights[i] * step.place(g.points[i]);
    const BodyId part = model.part_at(body, place);
    for (std::uint32_t i = 0; i < g.count; ++i)
      reader.take({.particle = g.points[i], .force = g.weights[i] * g.force, .part = part});
  });
}

void Grips::mark(Model& model, std::uint32_t body) {
  const bool may_be_free = model.bodies[body].count == 1 && model.articulates[model.bodies[body].articulate].count == 1;
  may_be_free ? model.mark_locally(body) : model.mark_pull(body);
}

bool Grips::holds(const Model& model, std::uint32_t particle) {
  return model.grips.has_any(model.particles[particle].body);
}

Vec3 Grips::point(const Model& model, const Grip& grip) {
  Vec3 sum;
  for (std::uint32_t i = 0; i < grip.count; ++i) sum += grip.weights[i] * model.position(grip.points[i]);
  return sum;
}

void Grips::anchor(const Model& model, Grip& grip, const Vec3& point) {
  const model::Body& body = model.bodies[grip.body];
  grip.count = body.rank;
  grip.points.fill(0), grip.weights.fill(0);
  const Vec3 origin = model.position(body.basis[0]);
  std::array<Vec3, 3> vectors;
  for (int i = 0; i < body.rank; ++i) {
    grip.points[i] = body.basis[i];
    if (i > 0) vectors[i - 1] = model.position(body.basis[i]) - origin;
  }
  Mat3 gram;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) gram.m[i][j] = dot(vectors[i], vectors[j]);
  const Vec3 r = point - origin;
  Vec3 c = solve_semidefinite(gram, {dot(vectors[0], r), dot(vectors[1], r), dot(vectors[2], r)}, 1e-12);
  if (body.rank == 2) c.x = std::clamp(c.x, 0.0, 1.0);
  grip.weights = {1 - c.x - c.y - c.z, c.x, c.y, c.z};
}

Grips::Memory Grips::remember(const Model& model, std::span<const std::uint32_t> bodies) {
  Memory held;
  if (model.grips.size() == 0) return held;
  model.grips.for_each([&](std::uint32_t slot, const Grip& g) {
    if (std::find(bodies.begin(), bodies.end(), g.body) == bodies.end()) return;
    const Vec3 place = point(model, g);
    std::uint32_t nearest = none;
    double least = 0;
    model.for_each_particle_of(g.body, [&](std::uint32_t p) {
      const double distance = norm(model.position(p) - place);
      if (nearest == none || distance < least) nearest = p, least = distance;
    });
    held.push_back({slot, place, model.particles.id(nearest), model.bodies.id(g.body)});
  });
  return held;
}

void Grips::reattach(Model& model, const Memory& held) {
  for (const Held& before : held) {
    if (!model.grips.is_alive(before.grip)) continue;
    Grip& grip = model.grips[before.grip];
    if (const auto particle = model.survivor_of(before.nearest)) {
      model.grips.move(before.grip, model.particles[particle->slot].body);
    } else if (const auto body = model.survivor_of(before.body)) {
      model.grips.move(before.grip, body->slot);
    } else {
      model.grips.destroy(before.grip);
      continue;
    }
    anchor(model, grip, before.point);
    model.mark_locally(grip.body);
  }
}

void Grips::prepare(Model& model, std::uint32_t slot) {
  const model::Body& body = model.bodies[slot];
  model.grips.for_each_of(slot, [&](std::uint32_t grip, const Grip& g) {
    const bool same =
        g.count == body.rank && std::equal(body.basis.begin(), body.basis.begin() + body.rank, g.points.begin());
    if (!same) anchor(model, model.grips[grip], point(model, g));
  });
}

}  // namespace iota::ingredient
