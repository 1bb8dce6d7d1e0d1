// SPDX-License-Identifier: Apache-2.0
#include "ingredient/grips.h"
#include "tests/cpp/ingredient/collected_loads.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

TEST(Grips, pull_at_the_points_that_carry_them_and_count_for_the_part_that_they_hold) {
  model::SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {4, 0, 0}});
  const std::uint32_t p = m.particle(rod, 0), q = m.particle(rod, 1);
  const BodyId other_part = m.model.bodies.id(m.body({{9, 9, 9}}));
  m.model.particles[q].part = other_part;
  model::Grip grip;
  grip.body = rod;
  model::anchor_grip(m.model, grip, {3, 0, 0});
  grip.force = {0, 4, 0};
  (void)m.model.grips.create(grip);
  const CollectedLoads<Grips> loads(m.model, rod);
  EXPECT_LT(norm(loads.on(p, Load::Kind::outside) - Vec3{0, 1, 0}), 1e-12);
  EXPECT_LT(norm(loads.on(q, Load::Kind::outside) - Vec3{0, 3, 0}), 1e-12);
  for (const Load& load : loads.list) EXPECT_EQ(load.part, other_part);
}

}  // namespace
}  // namespace iota::ingredient
