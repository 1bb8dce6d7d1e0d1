// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_frames.h"

#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace iota::ingredient::joint {
namespace {

const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

TEST(JointFrames, a_side_holds_the_directions_of_its_points) {
  model::SmallModel m;
  const Side world, point(m.model, m.body({{1, 2, 3}})), line(m.model, m.body({{0, 0, 0}, {0, 3, 0}})),
      plane(m.model, m.body({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}})),
      solid(m.model, m.body({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 1}}));
  const auto holds = [](const Side& side) { return std::array{side.holds(x), side.holds(y), side.holds(z)}; };
  EXPECT_EQ(holds(point), (std::array{false, false, false}));
  EXPECT_EQ(holds(line), (std::array{false, true, false}));
  EXPECT_EQ(holds(plane), (std::array{true, true, false}));
  EXPECT_EQ(holds(solid), (std::array{true, true, true}));
  EXPECT_EQ(holds(world), (std::array{true, true, true}));
  EXPECT_EQ(plane.extent, 3);
  EXPECT_EQ(line.what().substr(line.what().size() - 11), "on one line");
  EXPECT_TRUE(world.is_world());
}

TEST(JointFrames, tiny_and_huge_vectors_have_a_direction) {
  for (const double size : {1e-300, 1.0, 1e300})
    EXPECT_NEAR(norm(unit({3 * size, 4 * size, 0}) - Vec3{0.6, 0.8, 0}), 0, 1e-15);
}

TEST(JointFrames, a_frame_has_its_origin_and_three_ends_on_a_body_and_none_on_a_flat_one) {
  model::SmallModel m;
  const Side solid(m.model, m.body({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 1}}));
  Constraint c;
  c.particles.fill(none);
  make_frame(m.model, c, solid, b_origin, {0.5, 0.5, 0.5}, {});
  EXPECT_EQ(c.owned, 0xf0) << "four markers, all of b";
  EXPECT_LT(norm(position_of(m.model, c, b_axis) - Vec3{0.5, 0.5, 3.5}), 1e-12) << "3 m, the extent, along z";
  EXPECT_LT(norm(position_of(m.model, c, b_side) - Vec3{3.5, 0.5, 0.5}), 1e-12);
  require_frame("path", solid);
  EXPECT_THROW(require_frame("path", Side(m.model, m.body({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}))), std::invalid_argument);
}

}  // namespace
}  // namespace iota::ingredient::joint
