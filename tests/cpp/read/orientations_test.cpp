// SPDX-License-Identifier: Apache-2.0
// The drawn frames of rods.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace iota {
namespace {

/// Two hinged rods on the x-axis, the second with a frame that is twisted against that of the first.
struct TwistedRods {
  System system{SystemOptions{.gravity = {}}};
  std::array<BodyId, 2> rods{};
  std::array<ParticleId, 4> points{};  ///< along the x-axis; the middle two are hinged

  explicit TwistedRods(double twist) {
    for (std::size_t i = 0; i < 2; ++i) {
      rods[i] = system.bodies().create();
      const double from = static_cast<double>(i);
      points[2 * i] = system.particles().create(rods[i], {from, 0, 0});
      points[2 * i + 1] = system.particles().create(rods[i], {from + 1, 0, 0});
    }
    (void)system.edits().combine(points[1], points[2]);
    system.bodies().set_pose(rods[1], {1.5, 0, 0}, {std::sin(twist / 2), 0, 0, std::cos(twist / 2)});
  }
  /// About the x-axis.
  double twist() const {
    const Quaternion q = system.bodies().orientation(rods[1]);
    return 2 * std::atan2(q.x, q.w);
  }
};

TEST(Orientations, of_rods_lose_their_twist_by_steps_and_not_by_edits) {
  TwistedRods scene(1);
  System& system = scene.system;
  const double before = scene.twist();
  EXPECT_GT(before, 0.8);
  (void)system.particles().create(system.bodies().create(), {0, 5, 0});
  EXPECT_EQ(scene.twist(), before) << "an edit elsewhere";
  (void)system.edits().separate(scene.points[1], scene.points[2]);
  EXPECT_EQ(scene.twist(), before) << "a cut of its own hinge";
  (void)system.edits().combine(scene.points[1], scene.points[2]);
  (void)system.step(0.01);
  EXPECT_LT(scene.twist(), before - 0.05);
  for (int i = 0; i < 100; ++i) (void)system.step(0.01), (void)scene.twist();
  EXPECT_NEAR(scene.twist(), 0, 1e-6);
}

TEST(Orientations, of_a_solid_are_the_same_alone_and_with_those_of_all) {
  TwistedRods alone(1), together(1);
  std::vector<BodyId> boxes;
  for (TwistedRods* const scene : {&alone, &together}) {
    boxes.push_back(scene->system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.position = {0, 5, 0}}));
    scene->system.bodies().set_angular_velocity(boxes.back(), {1, 2, 3});
  }
  for (int i = 0; i < 20; ++i) {
    std::vector<Quaternion> found;
    for (TwistedRods* const scene : {&alone, &together}) {
      System& system = scene->system;
      (void)system.step(0.01);
      if (scene == &together) (void)scene->twist();
      const BodyId box = boxes[found.size()];
      system.bodies().set_pose(box, {0, 5.0 + i, 0}, system.bodies().orientation(box));
      found.push_back(system.bodies().orientation(box));
    }
    EXPECT_EQ(found[0].x, found[1].x);
    EXPECT_EQ(found[0].w, found[1].w);
    EXPECT_LT(found[0].w, 1);
  }
}

TEST(Orientations, of_rods_follow_an_edit_that_turns_them) {
  TwistedRods scene(0);
  System& system = scene.system;
  (void)system.bodies().orientation(scene.rods[1]);
  const ParticleId aside = system.particles().create(system.bodies().create(), {2, 1, 0});
  (void)system.edits().separate(scene.points[1], scene.points[2]);
  (void)system.edits().combine(scene.points[3], aside);
  const Quaternion q = system.bodies().orientation(scene.rods[1]);
  const Vec3 along = system.particles().position(scene.points[3]) - system.particles().position(scene.points[2]);
  ASSERT_GT(std::abs(along.y), 0.1) << "the edit has turned it";
  // The first axis of the frame.
  EXPECT_NEAR(1 - 2 * (q.y * q.y + q.z * q.z), along.x / norm(along), 1e-12);
  EXPECT_NEAR(2 * (q.x * q.y + q.w * q.z), along.y / norm(along), 1e-12);
}

}  // namespace
}  // namespace iota
