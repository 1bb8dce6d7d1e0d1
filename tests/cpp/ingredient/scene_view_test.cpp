// SPDX-License-Identifier: Apache-2.0
#include "ingredient/scene_view.h"

#include "tests/cpp/model/small_model.h"

#include <iota/scene.h>

#include <gtest/gtest.h>

#include <cmath>

namespace iota::ingredient {
namespace {

TEST(SceneView, gives_places_in_the_frame_of_a_body_about_its_center) {
  model::SmallModel small;
  const std::uint32_t body = small.body({{1, 0, 0}, {3, 0, 0}});
  const double half = std::sqrt(0.5);  // a quarter turn about z: the frame's x is the world's y
  small.model.bodies[body].orientation = {0, 0, half, half};
  const SceneView view(small.model, true);
  EXPECT_LT(norm(view.point_in(body, {2, 5, 0}) - Vec3{5, 0, 0}), 1e-14);
  EXPECT_LT(norm(view.into_body(body, {0, 0, 1}) - Vec3{0, 0, 1}), 1e-14);
  const Anchor end = view.anchor(small.particle(body, 1));
  EXPECT_EQ(end.body, small.model.bodies.id(body));
  EXPECT_LT(norm(end.point - Vec3{0, -1, 0}), 1e-14);
  const Anchor world = view.anchor(none, {7, 8, 9});
  EXPECT_EQ(world.body, BodyId{});
  EXPECT_EQ(world.point, (Vec3{7, 8, 9}));
}

}  // namespace
}  // namespace iota::ingredient
