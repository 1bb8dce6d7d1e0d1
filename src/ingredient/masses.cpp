// SPDX-License-Identifier: Apache-2.0
#include "ingredient/masses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include "ingredient/model.h"

namespace iota::ingredient {

namespace {

using Term = std::pair<std::uint32_t, double>;  // node, weight

/// Adds the kinetic energy 1/2 mass |sum_i w_i v_i|^2.
void add_mass(std::span<const Term> terms, double mass, Problem& problem) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    problem.add_mass(terms[i].first, mass * terms[i].second * terms[i].second);
    for (std::size_t j = i + 1; j < terms.size(); ++j)
      problem.couple_masses(terms[i].first, terms[j].first, mass * terms[i].second * terms[j].second);
  }
}

std::span<const Term> used(const WeightedNodes& list) {
  const auto end = std::find_if(list.begin(), list.end(), [](const Term& t) { return t.second == 0; });
  return {list.begin(), end};
}

void add_inertia_pair(const IslandMap& map, const model::InertiaPair& pair, Problem& problem) {
  std::array<Term, 8> difference{};
  std::size_t count = 0;
  const auto add = [&](const WeightedNodes& list, double sign) {
    for (const auto& [node, weight] : used(list)) {
      Term* const end = difference.data() + count;
      Term* const found =
          std::find_if(difference.data(), end, [node = node](const Term& t) { return t.first == node; });
      if (found == end) difference[count++] = {node, 0};
      found->second += sign * weight;
    }
  };
  add(map.nodes_of(pair.p), 1);
  add(map.nodes_of(pair.q), -1);
  add_mass({difference.data(), count}, pair.inertia, problem);
}

/// Of a marker that is an unknown of its own, kg.
double virtual_mass(const Model& model, std::uint32_t marker) {
  return 0.1 * model.body_mass(model.particles[marker].body);
}

}  // namespace

void Masses::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  auto& damping = problem.damping;
  for (const std::uint32_t body : map.bodies) {
    const double own = model.bodies[body].damping;
    if (!(own > 0)) {
      add_body(map, body, problem);
      continue;
    }
    // Bodies damp a node in the proportion of the masses that they give it.
    damping.resize(problem.size());
    const auto for_each_node = [&](auto visit) {
      model.for_each_particle_of(body, [&](std::uint32_t p) {
        if (!model.is_unknown(model.particles[p])) return;
        if (const std::uint32_t node = map.node_of(p); problem.is_open(node)) visit(node);
      });
    };
    for_each_node([&](std::uint32_t node) { damping[node] -= own * problem.mass[node]; });
    add_body(map, body, problem);
    for_each_node([&](std::uint32_t node) { damping[node] += own * problem.mass[node]; });
  }
  for (std::uint32_t node = 0; node < damping.size(); ++node)
    if (problem.is_open(node)) damping[node] /= problem.mass[node];
}

void Masses::leave(const IslandMap& map) {
  std::erase_if(virtual_, [&](std::uint32_t marker) { return map.has(map.model.particles[marker].body); });
}

void Masses::add_body(const IslandMap& map, std::uint32_t body, Problem& problem) {
  const Model& model = map.model;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const model::Particle& particle = model.particles[p];
    const Term own{map.node_of(p), 1.0};
    if (!particle.is_marker())
      add_mass(model.is_unknown(particle) ? std::span(&own, 1) : used(map.nodes_of(p)), particle.mass, problem);
    else if (model.is_unknown(particle) && model.ring_mass(particle.ring) == 0)
      add_virtual_mass(map, p, problem);
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) { add_inertia_pair(map, model.inertia_pairs[i], problem); });
}

// A marker that is an unknown of its own would leave an empty pivot. It gets mass that acts only against leaving its place
// in the body; the rows that tie it there make that motion zero.
void Masses::add_virtual_mass(const IslandMap& map, std::uint32_t marker, Problem& problem) {
  const model::Body& body = map.model.bodies[map.model.particles[marker].body];
  std::array<Term, 5> difference{{{map.node_of(marker), 1.0}}};
  const auto& weights = map.model.ties[marker].weights;
  std::size_t count = 1;
  for (int i = 0; i < body.rank; ++i)
    if (weights[i] != 0) difference[count++] = {map.node_of(body.basis[i]), -weights[i]};
  add_mass({difference.data(), count}, virtual_mass(map.model, marker), problem);
  virtual_.push_back(marker);
}

double Masses::virtual_energy(const Model& model) const {
  double twice = 0;
  for (const std::uint32_t marker : virtual_) {
    const Vec3 off = model.velocity(marker) - model.carried(marker).second;
    twice += virtual_mass(model, marker) * dot(off, off);
  }
  return twice / 2;
}

double Masses::after_step(Model& model, double h, Problem& problem) {
  const auto& damping = problem.damping;
  if (damping.empty() && !(model.damping > 0)) return 0;
  const double before = problem.kinetic_energy();
  for (std::size_t i = 0; i < problem.size(); ++i)
    problem.velocity[i] *= std::exp(-(model.damping + (damping.empty() ? 0 : damping[i])) * h);
  return before - problem.kinetic_energy();
}

void Masses::validate(const Model& model, model::Audit& audit) {
  model.bodies.for_each([&](std::uint32_t slot, const model::Body&) {
    model.for_each_inertia_of(slot, [&](std::uint32_t i) {
      const model::InertiaPair& pair = model.inertia_pairs[i];
      audit.require(model.inertia_pairs.is_alive(i) && pair.body == slot && model.particles[pair.p].body == slot &&
                        model.particles[pair.q].body == slot,
                    "inertia pair ", i, " is not of body ", slot);
    });
  });
}

void Masses::add_energy(const Scope& scope, Energies& sum) {
  const Model& model = scope.model;
  const Vec3 gravity = model.acting_gravity();
  scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
    const model::Ring& ring = model.rings[p.ring];
    sum.kinetic += 0.5 * p.mass * dot(ring.velocity, ring.velocity);
    sum.potential -= p.mass * dot(gravity, ring.position);
  });
  scope.for_each_inertia_pair([&](const model::InertiaPair& pair) {
    const Vec3 v = model.velocity(pair.p) - model.velocity(pair.q);
    sum.kinetic += 0.5 * pair.inertia * dot(v, v);
  });
}

void Masses::add_momentum(const Scope& scope, Momenta& sum) {
  const Model& model = scope.model;
  scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
    const model::Ring& ring = model.rings[p.ring];
    sum.linear += p.mass * ring.velocity;
    sum.angular += p.mass * cross(ring.position, ring.velocity);
  });
  scope.for_each_inertia_pair([&](const model::InertiaPair& pair) {
    sum.angular += pair.inertia * cross(model.position(pair.p) - model.position(pair.q),
                                        model.velocity(pair.p) - model.velocity(pair.q));
  });
}

void Masses::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  const Vec3 gravity = model.acting_gravity();
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const model::Particle& particle = model.particles[p];
    if (particle.is_marker()) return;
    reader.take({.particle = p, .force = particle.mass * (gravity - step.damping(p)), .part = particle.part});
    reader.take({.particle = p,
                 .force = -particle.mass * step.acceleration(p),
                 .kind = Load::Kind::inertia,
                 .part = particle.part});
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) {
    const model::InertiaPair& pair = model.inertia_pairs[i];
    const BodyId part = model.particles[pair.p].part;
    const BodyId common = part == model.particles[pair.q].part ? part : BodyId{};
    const auto take = [&](const Vec3& on_p, Load::Kind kind) {
      reader.take({.particle = pair.p, .force = on_p, .kind = kind, .part = common});
      reader.take({.particle = pair.q, .force = -on_p, .kind = kind, .part = common});
    };
    take(-pair.inertia * (step.damping(pair.p) - step.damping(pair.q)), Load::Kind::outside);
    take(-pair.inertia * (step.acceleration(pair.p) - step.acceleration(pair.q)), Load::Kind::inertia);
  });
}

}  // namespace iota::ingredient
