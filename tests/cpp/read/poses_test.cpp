// SPDX-License-Identifier: Apache-2.0
#include "read/poses.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace iota {
namespace {

TEST(Poses, are_those_of_the_bodies_that_act) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId moving = system.bodies().create(Box{}, {.position = {1, 2, 3}, .velocity = {1, 0, 0}});
  const BodyId still = system.bodies().create(Sphere{0.5}, {.position = {4, 5, 6}, .kind = BodyKind::static_});
  const BodyId off = system.bodies().create(Sphere{0.5});
  (void)system.bodies().create();  // without particles
  system.bodies().set_active(off, false);
  (void)system.step(0.5);
  const PoseSnapshot poses = system.viewer().poses();
  EXPECT_EQ(poses.step, 1u);
  EXPECT_EQ(poses.time, 0.5);
  ASSERT_EQ(poses.bodies.size(), 2u);
  EXPECT_EQ(poses.bodies[0].body, moving.slot);
  EXPECT_NEAR(poses.bodies[0].position[0], 1.5, 1e-6);
  EXPECT_NEAR(poses.bodies[0].orientation[3], 1, 1e-6);
  EXPECT_EQ(poses.bodies[1].body, still.slot);
  EXPECT_NEAR(poses.kinetic, 500, 1e-3);  // 1000 kg at 1 m/s
}

TEST(Poses, of_an_emitters_free_particles_are_dots_with_their_color) {
  System system{SystemOptions{.gravity = {}}};
  const EmitterId emitter = system.emitters().create(
      {.rate = 100, .position = {1, 2, 3}, .velocity = {}, .curve = {{0, 0.25, {1, 0.5f, 2, 1}}}});
  (void)system.step(0.02);
  const PoseSnapshot poses = system.viewer().poses();
  ASSERT_EQ(poses.sparks.size(), 2u);
  EXPECT_TRUE(poses.bodies.empty());
  for (const SparkPose& spark : poses.sparks) {
    EXPECT_EQ(spark.set, emitter.slot);
    EXPECT_EQ(spark.radius, 0.25f);
    EXPECT_EQ(spark.color, 0xff80ffu) << "above 1 is full";
    EXPECT_NEAR(spark.position[1], 2, 0.011);
  }
  // One that is bonded is a body like any other.
  const ParticleId p = system.emitters().particles(emitter)[0], q = system.emitters().particles(emitter)[1];
  (void)system.bonds().create(p, q, SpringLaw{});
  EXPECT_EQ(system.viewer().poses().bodies.size(), 2u);
  EXPECT_TRUE(system.viewer().poses().sparks.empty());
}

}  // namespace
}  // namespace iota
