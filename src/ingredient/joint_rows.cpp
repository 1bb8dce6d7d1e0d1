// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_rows.h"

#include <tuple>

namespace iota::ingredient {

RowsOf rows_of(const CoordinateOptions& o) {
  return {std::isfinite(o.lower) || std::isfinite(o.upper), o.motor_max > 0, o.friction > 0,
          o.stiffness > 0 || o.damping > 0};
}

namespace joint {

JointPlaces::JointPlaces(const Model& model, const Constraint& c) {
  for (int place = 0; place < place_count; ++place) {
    if (!c.has(place)) continue;
    position[place] = position_of(model, c, place);
    if (c.particles[place] == none) {
      arms[place].constant = position[place];
    } else {
      arms[place].nodes[0] = {static_cast<std::uint32_t>(place), 1.0};
      // Like the solver's rows: in a conflict a particle may differ from its place in the body.
      std::tie(position[place], velocity[place]) = model.carried(c.particles[place]);
    }
  }
}

std::array<Vec3, place_count> JointPlaces::calc_start(const LastStep& step, const Constraint& c) const {
  std::array<Vec3, place_count> start = position;
  for (int place = 0; place < place_count; ++place) {
    if (!c.has(place) || c.particles[place] == none) continue;
    const model::Body& body = step.model.bodies[step.model.particles[c.particles[place]].body];
    const std::array<double, 4> weights = step.model.weights(c.particles[place]);
    start[place] = {};
    for (int i = 0; i < body.rank; ++i)
      if (weights[i] != 0) start[place] += weights[i] * step.start(body.basis[i]);
  }
  return start;
}

std::optional<PlaceArms> arms_of(const IslandMap& map, const Constraint& c) {
  const Model& model = map.model;
  PlaceArms places{};
  for (int place = 0; place < place_count; ++place) {
    if (!c.has(place)) continue;
    if (c.particles[place] == none) {
      places[place].constant = c.fixed[place - b_origin];
      continue;
    }
    // Through the basis, even if the particle is an unknown of its own: so a row couples only two bodies.
    const model::Body& body = model.bodies[model.particles[c.particles[place]].body];
    const std::array<double, 4> weights = model.weights(c.particles[place]);
    int used = 0;
    for (int i = 0; i < body.rank; ++i) {
      if (weights[i] == 0) continue;
      const std::uint32_t node = map.node_of(body.basis[i]);
      if (node == none) return std::nullopt;
      places[place].nodes[used++] = {node, weights[i]};
    }
  }
  return places;
}

}  // namespace joint

}  // namespace iota::ingredient
