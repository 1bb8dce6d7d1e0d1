// SPDX-License-Identifier: Apache-2.0
#include "ingredient/closings.h"

#include "base/text.h"

#include <algorithm>

namespace iota::ingredient {

namespace {

using Pool = solver::ConstraintPool<solver::DistanceConstraint>;

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
  for (const std::uint32_t body : map.nodes.bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.for_each_closing_of(p, [&](std::uint32_t c) {
        const model::Closing& closing = model.closings[c];
        // An inactive body has no nodes.
        if (closing.p == p && map.node_of(closing.p) != none && map.node_of(closing.q) != none) slots_.push_back(c);
      });
    });
  std::sort(slots_.begin(), slots_.end());
  auto& distances = constraints_in<solver::DistanceConstraint>(problem);
  first_ = static_cast<std::uint32_t>(distances.size());
  for (const std::uint32_t slot : slots_) {
    const model::Closing& c = model.closings[slot];
    distances.push_back({{map.node_of(c.p), map.node_of(c.q)}, c.distance, c.distance});
  }
}

void Closings::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  auto& distances = std::get<Pool>(problem.constraints);
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const model::Closing& c = model.closings[slots_[i]];
    distances.multipliers[first_ + i] = c.multiplier;
    distances.items[first_ + i].length = c.distance * closing_factor(c.elapsed + h, c.duration);
  }
}

void Closings::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  const auto& distances = std::get<Pool>(problem.constraints);
  for (std::size_t i = 0; i < slots_.size(); ++i)
    model.closings[slots_[i]].multiplier = distances.multipliers[first_ + i];
}

std::string Closings::name_of_row(const Model& model, const IslandNodes&, const solver::RowName& row) const {
  if (row.pool != pool_index<solver::DistanceConstraint> || row.item - first_ >= slots_.size()) return {};
  const model::Closing& c = model.closings[slots_[row.item - first_]];
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
