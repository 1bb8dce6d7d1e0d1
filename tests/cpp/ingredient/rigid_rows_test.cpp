// SPDX-License-Identifier: Apache-2.0
#include "ingredient/rigid_rows.h"
#include "tests/cpp/ingredient/collected_loads.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

TEST(RigidRows, pull_their_two_points_together_by_the_multiplier) {
  model::SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {2, 0, 0}});
  m.model.row(rod, 0).multiplier = 5;
  const CollectedLoads<RigidRows> loads(m.model, rod);
  EXPECT_EQ(loads.on(m.particle(rod, 0), Load::Kind::within), (Vec3{5, 0, 0}));
  EXPECT_EQ(loads.on(m.particle(rod, 1), Load::Kind::within), (Vec3{-5, 0, 0}));
}

TEST(RigidRows, their_gap_is_of_bodies_that_can_move) {
  model::SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {2, 0, 0}});
  m.model.rings[m.model.particles[m.particle(rod, 1)].ring].position = {2.5, 0, 0};
  EXPECT_EQ(RigidRows::worst_gap(Scope(m.model)), 0.5);
  m.model.bodies[rod].kind = BodyKind::static_;
  EXPECT_EQ(RigidRows::worst_gap(Scope(m.model)), 0);
}

}  // namespace
}  // namespace iota::ingredient
