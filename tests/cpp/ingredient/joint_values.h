// SPDX-License-Identifier: Apache-2.0
// Two bodies, the rows of a joint between them, and their values.
#pragma once

#include "ingredient/joint_forms.h"
#include "tests/cpp/model/small_model.h"

#include <iota/constraints.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace iota::ingredient {

/// Two bodies of four corners, 5 m apart.
struct TwoBlocks {
  model::SmallModel m;
  std::uint32_t a = m.body({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  std::uint32_t b = m.body({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});

  JointSpec spec(ConstraintKind kind) const {
    return {.kind = kind, .a = m.model.bodies.id(a), .b = m.model.bodies.id(b), .at = {2, 0.2, 0.3}, .axis = {0, 0, 2}};
  }
  ParticleId particle(std::uint32_t body, int n) const { return m.model.particles.id(m.particle(body, n)); }
  void move(std::uint32_t body, const Vec3& by) {
    m.model.for_each_particle_of(body,
                                 [&](std::uint32_t p) { m.model.rings[m.model.particles[p].ring].position += by; });
  }
};

struct JointValues {
  std::vector<double> held;
  int coordinates = 0;  ///< rows of limits, motors, friction and springs

  double worst() const {
    double most = 0;
    for (const double value : held) most = std::max(most, std::abs(value));
    return most;
  }
};

/// The rows at the present places of the particles.
inline JointValues values_of(const Model& model, std::uint32_t slot) {
  const Constraint& c = model.constraints[slot];
  const joint::JointPlaces places(model, c);
  JointValues values;
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    if (use.role != joint::Role::hold) return void(++values.coordinates);
    Row loaded = row;
    double multipliers[Row::rows], g[Row::rows];
    joint::load_hold(loaded, model, c, use, multipliers);
    loaded.value(places.position.data(), 1, g);
    values.held.insert(values.held.end(), g, g + Row::rows);
  };
  joint::build_rows({c, model.geometry(slot), places.arms}, sink);
  return values;
}

}  // namespace iota::ingredient
