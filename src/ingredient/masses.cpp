// SPDX-License-Identifier: Apache-2.0
#include "ingredient/masses.h"

#include "ingredient/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

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

/// A marker that is an unknown of its own would have a zero pivot. It gets a mass that resists only motion relative to
/// its body, which the rows that tie it make zero.
bool has_virtual_mass(const Model& model, std::uint32_t marker) {
  const model::Particle& particle = model.particles[marker];
  return particle.is_marker() && model.is_unknown(particle) && model.ring_mass(particle.ring) == 0;
}
double virtual_mass(const Model& model, std::uint32_t marker) {
  return 0.1 * model.body_mass(model.particles[marker].body);
}

/// A sum of velocities of nodes.
class Difference {
 public:
  void add(std::span<const Term> terms, double sign) {
    for (const auto& [node, weight] : terms) {
      Term* const end = terms_.data() + count_;
      Term* const found = std::find_if(terms_.data(), end, [node = node](const Term& t) { return t.first == node; });
      if (found == end) terms_[count_++] = {node, 0};
      found->second += sign * weight;
    }
  }
  std::span<const Term> terms() const { return {terms_.data(), count_}; }

 private:
  std::array<Term, 8> terms_{};
  std::size_t count_ = 0;
};

/// visit(terms, mass) for each part 1/2 mass |sum_i w_i v_i|^2 of a body's kinetic energy. nodes_of(particle): its own node,
/// or those that carry it.
template <class NodesOf, class Visit>
void for_each_mass(const Model& model, std::uint32_t body, NodesOf nodes_of, Visit visit) {
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const WeightedNodes own = nodes_of(p);
    if (const model::Particle& particle = model.particles[p]; !particle.is_marker()) {
      visit(used(own), particle.mass);
    } else if (has_virtual_mass(model, p)) {
      Difference off;
      off.add(used(own), 1);
      const model::Body& record = model.bodies[body];
      for (int i = 0; i < record.rank; ++i)
        if (const double weight = model.affine[p].weights[i]; weight != 0)
          off.add(used(nodes_of(record.basis[i])), -weight);
      visit(off.terms(), virtual_mass(model, p));
    }
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) {
    const model::InertiaPair& pair = model.inertia_pairs[i];
    Difference difference;
    difference.add(used(nodes_of(pair.p)), 1);
    difference.add(used(nodes_of(pair.q)), -1);
    visit(difference.terms(), pair.inertia);
  });
}

}  // namespace

void Masses::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  auto& damping = problem.damping;
  for (const std::uint32_t body : map.bodies) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (has_virtual_mass(model, p)) virtual_.push_back(p);
    });
    const double own = model.body_damping[body];
    if (own > 0) damping.resize(problem.size());
    for_each_mass(
        model, body, [&](std::uint32_t p) { return map.nodes_of(p); },
        [&](std::span<const Term> terms, double mass) {
          add_mass(terms, mass, problem);
          if (!(own > 0)) return;
          for (const auto& [node, weight] : terms)
            if (problem.is_open(node)) damping[node] += own * mass * weight * weight;
        });
  }
  for (std::uint32_t node = 0; node < damping.size(); ++node)
    if (problem.is_open(node)) damping[node] /= problem.mass[node];
}

double Masses::damping_rate(const Model& model, std::uint32_t ring) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  const auto for_each_body = [&](auto visit) {
    model.for_each_in_ring(ring, [&](std::uint32_t p) {
      const std::uint32_t body = model.particles[p].body;
      if (model.bodies[body].kind != BodyKind::inactive) visit(body, model.body_damping[body]);
    });
  };
  for_each_body([&](std::uint32_t, double own) { least = std::min(least, own), most = std::max(most, own); });
  if (!(least < most)) return model.damping + most;
  double mass = 0, damped = 0;
  for_each_body([&](std::uint32_t body, double own) {
    for_each_mass(
        model, body, [&](std::uint32_t p) { return rings_that_carry(model, p); },
        [&](std::span<const Term> terms, double of_terms) {
          for (const auto& [node, weight] : terms)
            if (node == ring) mass += of_terms * weight * weight, damped += own * of_terms * weight * weight;
        });
  });
  return model.damping + (mass > 0 ? damped / mass : 0);
}

void Masses::leave(const IslandMap& map) {
  std::erase_if(virtual_, [&](std::uint32_t marker) { return map.has(map.model.particles[marker].body); });
}

double Masses::virtual_energy(const Model& model) const {
  double twice = 0;
  for (const std::uint32_t marker : virtual_) {
    const Vec3 off = model.velocity(marker) - model.carried(marker).second;
    twice += virtual_mass(model, marker) * dot(off, off);
  }
  return twice / 2;
}

void Masses::load(const Model& model, const IslandNodes&, double /*h*/, Problem& problem) {
  problem.usual_damping = model.damping;
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
  double kinetic = sum.kinetic, potential = sum.potential;  // in registers: the next addition waits for the last one
  scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
    const model::Ring& ring = model.rings[p.ring];
    kinetic += 0.5 * p.mass * dot(ring.velocity, ring.velocity);
    potential -= p.mass * dot(gravity, ring.position);
  });
  scope.for_each_inertia_pair([&](const model::InertiaPair& pair) {
    const Vec3 v = model.velocity(pair.p) - model.velocity(pair.q);
    kinetic += 0.5 * pair.inertia * dot(v, v);
  });
  sum = {kinetic, potential};
}

void Masses::add_momentum(const Scope& scope, Momenta& sum) {
  const Model& model = scope.model;
  Vec3 linear = sum.linear, angular = sum.angular;  // in registers, as above
  scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
    const model::Ring& ring = model.rings[p.ring];
    linear += p.mass * ring.velocity;
    angular += p.mass * cross(ring.position, ring.velocity);
  });
  scope.for_each_inertia_pair([&](const model::InertiaPair& pair) {
    angular += pair.inertia *
               cross(model.position(pair.p) - model.position(pair.q), model.velocity(pair.p) - model.velocity(pair.q));
  });
  sum = {linear, angular};
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
    reader.take(
        {.particle = p, .force = -particle.mass * step.correction(p), .kind = Load::Kind::jump, .part = particle.part});
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
    take(-pair.inertia * (step.correction(pair.p) - step.correction(pair.q)), Load::Kind::jump);
  });
}

}  // namespace iota::ingredient
