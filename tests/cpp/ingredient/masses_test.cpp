// SPDX-License-Identifier: Apache-2.0
#include "ingredient/masses.h"
#include "tests/cpp/ingredient/collected_loads.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::ingredient {
namespace {

TEST(Masses, weigh_and_resist_acceleration) {
  model::SmallModel m;
  m.model.gravity = {0, -10, 0};
  const std::uint32_t body = m.body({{0, 0, 0}}, 3), p = m.particle(body, 0);
  m.model.rings[m.model.particles[p].ring].acceleration = {2, 0, 0};
  const CollectedLoads<Masses> loads(m.model, body);
  EXPECT_EQ(loads.on(p, Load::Kind::outside), (Vec3{0, -30, 0}));
  EXPECT_EQ(loads.on(p, Load::Kind::inertia), (Vec3{-6, 0, 0}));
}

TEST(Masses, are_damped_by_the_exponential_law) {
  model::SmallModel m;
  m.model.gravity = {};
  m.model.last_dt = 0.1, m.model.damping = 2;
  const std::uint32_t body = m.body({{0, 0, 0}}, 3), p = m.particle(body, 0);
  m.model.set_damping(body, 1);
  model::Ring& ring = m.model.rings[m.model.particles[p].ring];
  ring.velocity = {std::exp(-0.3), 0, 0};  // was 1
  ring.acceleration = {(std::exp(-0.3) - 1) / 0.1, 0, 0};
  const CollectedLoads<Masses> loads(m.model, body);
  EXPECT_LT(norm(loads.on(p, Load::Kind::outside) + loads.on(p, Load::Kind::inertia)), 1e-12);
}

TEST(Masses, an_inertia_pair_acts_on_both_ends_alike) {
  model::SmallModel m;
  m.model.gravity = {};
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}});
  model::InertiaPair pair;
  pair.body = body, pair.p = m.particle(body, 0), pair.q = m.particle(body, 1), pair.inertia = -0.25;
  m.model.bodies[body].first_inertia = m.model.inertia_pairs.create(pair).slot;
  m.model.rings[m.model.particles[pair.q].ring].acceleration = {0, 4, 0};
  const CollectedLoads<Masses> loads(m.model, body);
  EXPECT_EQ(loads.on(pair.q, Load::Kind::inertia), (Vec3{0, -4 + 1, 0}));
  EXPECT_EQ(loads.on(pair.p, Load::Kind::inertia), (Vec3{0, -1, 0}));
}

}  // namespace
}  // namespace iota::ingredient
