// SPDX-License-Identifier: Apache-2.0
// A joint with a row of its own, added by a line in each of a few lists.
#include "solver/constraints/level.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>

namespace iota {
namespace {

TEST(Level, holds_the_weight_of_a_body_at_the_height_of_a_post_and_lets_it_slide) {
  System system({.rest = {.after = 0}});
  const BodyId post = system.bodies().create(Box{}, {.position = {3, 1, 0}, .kind = BodyKind::static_});
  const BodyId block = system.bodies().create(Box{}, {.mass = 2, .position = {0, 1, 0}, .velocity = {0.5, 0, 0}});
  const ConstraintId level =
      system.joints().create(JointSpec{.kind = ConstraintKind::level, .a = block, .b = post, .at = {0, 1, 0}});
  for (int i = 0; i < 120; ++i) ASSERT_EQ(system.step(1.0 / 120).unconverged, 0);
  EXPECT_LT(norm(system.bodies().center_of_mass(block) - Vec3{0.5, 1, 0}), 1e-6);
  EXPECT_LT(norm(system.joints().state(level).force - Vec3{0, 2 * 9.81, 0}), 1e-4) << "its row is read as any other";
  EXPECT_LT(system.joints().state(level).gap, 1e-9);
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iota
