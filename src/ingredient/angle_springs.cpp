// SPDX-License-Identifier: Apache-2.0
#include "ingredient/angle_springs.h"

#include "base/sort_unique.h"
#include "ingredient/model.h"
#include "math/checks.h"

#include <array>
#include <cmath>
#include <numbers>

namespace iota::ingredient {

namespace {

/// The solver's spring; the nodes of its points are 0, 1 and 2.
solver::SpringForce force_of(const AngleSpring& spring) {
  const auto [a, b] = spring.lengths;
  const double s = a * b / (a + b), per_angle = s * std::sin(spring.rest / 2);  // d|e| / dangle at rest
  solver::SpringForce force;
  force.arm.count = 3;
  force.arm.nodes = {0, 1, 2};
  force.arm.weights = {b / (a + b), -1, a / (a + b)};
  force.length = spring.rest < std::numbers::pi ? 2 * s * std::cos(spring.rest / 2) : 0;
  force.stiffness = spring.stiffness / (per_angle * per_angle);
  force.damping = spring.damping / (per_angle * per_angle);
  return force;
}

/// Whether its three particles are apart and none is switched off.
bool is_in_force(const Model& model, const AngleSpring& spring) {
  std::array<std::uint32_t, AngleSpring::count> rings;
  for (std::uint32_t end = 0; end < rings.size(); ++end) {
    if (!model.acts(spring.at(end))) return false;
    rings[end] = model.particles[spring.at(end)].ring;
  }
  return rings[0] != rings[1] && rings[1] != rings[2] && rings[2] != rings[0];
}

std::array<Vec3, AngleSpring::count> places(const Model& model, const AngleSpring& spring) {
  return {model.position(spring.at(0)), model.position(spring.at(1)), model.position(spring.at(2))};
}

double energy(const Model& model, std::uint32_t slot) {
  const AngleSpring& spring = model.angle_springs[slot];
  if (!is_in_force(model, spring)) return 0;
  const solver::SpringForce force = force_of(spring);
  return force.energy(force.arm.value(places(model, spring).data()));
}

constexpr double least_rest = 0.01;  // rad: the energy is a function of the chord's middle, which hardly changes near 0

/// Takes the options of a command.
template <class C>
void take_options(AngleSpring& spring, const Model& model, const C& c) {
  const double rest = std::isnan(c.rest) ? AngleSprings::angle(model, spring) : c.rest;
  require_not_negative("stiffness", c.stiffness);
  require_not_negative("damping", c.damping);
  if (!(rest >= least_rest && rest <= std::numbers::pi))
    throw std::invalid_argument(
        text("the rest angle of an angle spring must be between 0.01 and pi (straight), got ", rest));
  spring.stiffness = c.stiffness, spring.damping = c.damping, spring.rest = rest;
}

/// It begins or ends to need its particles as unknowns.
void note_ends(Model& model, const AngleSpring& spring, int uses) {
  for (const std::uint32_t particle : spring.particles) {
    model.particles[particle].uses += static_cast<std::uint32_t>(uses);
    model.mark_locally(model.particles[particle].body);
  }
}

void remove_spring(Model& model, std::uint32_t slot) {
  note_ends(model, model.angle_springs[slot], -1);
  model.angle_springs.destroy(slot);
}

}  // namespace

void AngleSprings::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.angle_springs.size() == 0) return;
  std::vector<std::uint32_t> slots;
  for (const std::uint32_t body : map.bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.angle_springs.for_each_of(p, [&](std::uint32_t slot) { slots.push_back(slot); });
    });
  sort_unique(slots);
  for (const std::uint32_t slot : slots) {
    const AngleSpring& spring = model.angle_springs[slot];
    if (!is_in_force(model, spring)) continue;
    solver::SpringForce force = force_of(spring);
    for (std::uint32_t end = 0; end < AngleSpring::count; ++end) force.arm.nodes[end] = map.node_of(spring.at(end));
    problem.add(force, {owner, {}, slot});
  }
}

void AngleSprings::load(const Model& model, const IslandNodes&, double, Problem& problem) {
  for_each_item_of<solver::SpringForce>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    solver::SpringForce& force = problem.pool_of<solver::SpringForce>().items[i];
    const solver::SpringForce now = force_of(model.angle_springs[key.slot]);
    force.stiffness = now.stiffness, force.damping = now.damping, force.length = now.length;
  });
}

void AngleSprings::check_links(const Model& model, model::Audit& audit) {
  audit.check_ends("angle spring", model.angle_springs);
}

void AngleSprings::validate(const Model& model, model::Audit& audit) {
  model.angle_springs.for_each([&](std::uint32_t slot, const AngleSpring& spring) {
    audit.require_ends("angle spring", slot, spring);
    for (std::uint32_t end = 0; end < AngleSpring::count; ++end) audit.use_particle(spring.at(end));
    const auto [a, b] = spring.lengths;
    const bool is_whole = spring.stiffness >= 0 && spring.damping >= 0 && spring.rest > 0 &&
                          spring.rest <= std::numbers::pi && a > 0 && b > 0 &&
                          std::isfinite(spring.stiffness + spring.damping + a + b);
    audit.require(is_whole, "angle spring ", slot, " has a number out of its range");
  });
  audit.require_listed("angle spring", model.angle_springs);
}

void AngleSprings::add_energy(const Scope& scope, Energies& sum) {
  const Model& model = scope.model;
  if (scope.is_whole())
    model.angle_springs.for_each([&](std::uint32_t slot, const AngleSpring&) { sum.potential += energy(model, slot); });
  else if (model.angle_springs.size() > 0)
    scope.for_each_particle([&](std::uint32_t p, const model::Particle&) {
      model.angle_springs.for_each_of(p, [&](std::uint32_t slot) {
        if (model.angle_springs[slot].at(0) == p) sum.potential += energy(model, slot);
      });
    });
}

void AngleSprings::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (model.angle_springs.size() == 0 || !(step.h() > 0)) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.angle_springs.for_each_of(p, [&](std::uint32_t slot) {
      const AngleSpring& spring = model.angle_springs[slot];
      if (!is_in_force(model, spring)) return;
      const solver::SpringForce force = force_of(spring);
      std::array<Vec3, AngleSpring::count> start, end;
      for (std::uint32_t i = 0; i < AngleSpring::count; ++i)
        start[i] = step.start(spring.at(i)), end[i] = step.end(spring.at(i));
      const Vec3 along = force.force(force.arm.value(start.data()), force.arm.value(end.data()), step.stage);
      for (std::uint32_t i = 0; i < AngleSpring::count; ++i)
        if (spring.at(i) == p)
          reader.take({.particle = p, .force = force.arm.weights[i] * along, .part = model.particles[p].part});
    });
  });
}

bool AngleSprings::holds(const Model& model, std::uint32_t particle) { return model.angle_springs.ends_at(particle); }

bool AngleSprings::ties_any(const Model& model) { return model.angle_springs.size() > 0; }

void AngleSprings::visit_tied(const Model& model, std::uint32_t particle, Visit visit) {
  model.angle_springs.for_each_of(particle, [&](std::uint32_t slot) {
    const AngleSpring& spring = model.angle_springs[slot];
    if (!is_in_force(model, spring)) return;
    for (std::uint32_t end = 0; end < AngleSpring::count; ++end)
      if (spring.at(end) != particle) visit(model.particles[spring.at(end)].body);
  });
}

void AngleSprings::absorb(Model& model, std::uint32_t q, std::uint32_t p) {
  const auto moved = [&](std::uint32_t) {
    --model.particles[q].uses, ++model.particles[p].uses;
    model.mark_particle(p);
  };
  model.angle_springs.redirect(q, p, moved, [&](std::uint32_t slot) { remove_spring(model, slot); });
}

void AngleSprings::drop(Model& model, std::uint32_t particle) {
  model.angle_springs.for_each_of(particle, [&](std::uint32_t slot) { remove_spring(model, slot); });
}

Id<"angle spring"> AngleSprings::apply(Model& model, const CreateAngleSpring& c) {
  AngleSpring spring;
  spring.particles = {require(model, c.p), require(model, c.middle), require(model, c.q)};
  const Vec3 middle = model.position(c.middle.slot);
  spring.lengths = {norm(model.position(c.p.slot) - middle), norm(model.position(c.q.slot) - middle)};
  if (!(spring.lengths[0] > 0 && spring.lengths[1] > 0) || c.p == c.q)
    throw std::invalid_argument(
        text("an angle spring needs three particles, the middle one away from the others, got particles ", c.p.slot,
             ", ", c.middle.slot, " and ", c.q.slot));
  take_options(spring, model, c);
  ++model.structure_version;
  note_ends(model, spring, 1);
  return model.angle_springs.id(model.angle_springs.create(spring));
}

void AngleSprings::apply(Model& model, const SetAngleSpring& c) {
  AngleSpring& spring = model.angle_springs[require(model, c.spring)];
  take_options(spring, model, c);
  model.wake(model.bodies[model.particles[spring.at(1)].body].articulate);
}

void AngleSprings::apply(Model& model, const Destroy<Id<"angle spring">>& c) {
  remove_spring(model, require(model, c.id));
  ++model.structure_version;
}

double AngleSprings::angle(const Model& model, const AngleSpring& spring) {
  const auto [p, middle, q] = places(model, spring);
  const Vec3 to_p = p - middle, to_q = q - middle;
  return std::atan2(norm(cross(to_p, to_q)), dot(to_p, to_q));
}

// With |e| = 2 s cos(angle / 2).
double AngleSprings::moment(const Model& model, std::uint32_t slot) {
  const AngleSpring& spring = model.angle_springs[slot];
  if (!is_in_force(model, spring)) return 0;
  const solver::SpringForce force = force_of(spring);
  const auto [a, b] = spring.lengths;
  const double stretch = norm(force.arm.value(places(model, spring).data())) - force.length;
  return force.stiffness * stretch * a * b / (a + b) * std::sin(angle(model, spring) / 2);
}

}  // namespace iota::ingredient
