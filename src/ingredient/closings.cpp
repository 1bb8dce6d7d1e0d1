// SPDX-License-Identifier: Apache-2.0
#include "ingredient/closings.h"

#include "base/text.h"

#include <algorithm>

namespace iota::ingredient {

namespace {

/// Shrinks smoothly from 1 to a hundredth. Each step moves positions only: forces that close the distance in a given time
/// overshoot (measured: they add 25 to 120 J where this adds 0.03 J). A distance row has no direction at 0, so a projection
/// closes the last bit.
double closing_factor(double elapsed, double duration) {
  const double s = std::clamp(elapsed / duration, 0.0, 1.0);
  return 1 - 0.99 * s * s * (3 - 2 * s);
}

}  // namespace

void Closings::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.closings.size() == 0) return;
  std::vector<std::uint32_t> slots;
  for (const std::uint32_t body : map.bodies)
    model.for_each_particle_of(
        body, [&](std::uint32_t p) { model.for_each_closing_of(p, [&](std::uint32_t c) { slots.push_back(c); }); });
  sort_unique(slots);
  for (const std::uint32_t slot : slots) {
    const model::Closing& c = model.closings[slot];
    const std::uint32_t a = map.node_of(c.p), b = map.node_of(c.q);
    if (a == none || b == none) continue;  // of an inactive body
    problem.add(solver::DistanceConstraint{{a, b}, c.distance, c.distance}, {owner, {}, slot});
  }
}

void Closings::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  if (model.closings.size() == 0) return;
  auto& distances = problem.pool_of<solver::DistanceConstraint>();
  for_each_item_of<solver::DistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const model::Closing& c = model.closings[key.slot];
    distances.multipliers[i] = c.multiplier;
    distances.items[i].length = c.distance * closing_factor(c.elapsed + h, c.duration);
  });
}

void Closings::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  if (model.closings.size() == 0) return;
  const auto& distances = problem.pool_of<solver::DistanceConstraint>();
  for_each_item_of<solver::DistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    model.closings[key.slot].multiplier = distances.multipliers[i];
  });
}

std::string Closings::name_of_row(const Model& model, solver::ItemKey key) const {
  const model::Closing& c = model.closings[key.slot];
  return text("the closing of particles ", c.p, " and ", c.q);
}

void Closings::validate(const Model& model, model::Audit& audit) {
  model.closings.for_each([&](std::uint32_t, const model::Closing& c) {
    const model::Particle &p = model.particles[c.p], &q = model.particles[c.q];
    audit.join(p.body, q.body);
    audit.use_particle(c.p), audit.use_particle(c.q);
    audit.require(p.ring != q.ring && p.body != q.body, "a closing of particles ", c.p, " and ", c.q,
                  " has nothing to close");
  });
  audit.require_listed("closing", model.closings, &model::References::first_closing);
}

bool Closings::holds(const Model& model, std::uint32_t particle) {
  return model.references[particle].first_closing != none;
}

}  // namespace iota::ingredient
