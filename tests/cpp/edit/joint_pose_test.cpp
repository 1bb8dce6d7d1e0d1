// SPDX-License-Identifier: Apache-2.0
#include "edit/joint_pose.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace iota {
namespace {

/// Two boxes on hinges one after the other: an arm of two members of 1 m along x from the origin.
struct Arm {
  System system{SystemOptions{.gravity = {}}};
  std::array<BodyId, 2> members;
  std::array<ConstraintId, 2> hinges;

  Arm() {
    for (std::size_t i = 0; i < 2; ++i) {
      const double start = static_cast<double>(i);
      members[i] = system.bodies().create(Box{{0.8, 0.1, 0.1}}, {.position = {start + 0.5, 0, 0}});
      hinges[i] = system.joints().create(JointSpec{.a = members[i],
                                                   .b = i == 0 ? BodyId{} : members[0],
                                                   .at = {start, 0, 0},
                                                   .axis = {0, 0, 1},
                                                   .angle = {.lower = -2, .upper = 2}});
    }
  }
  Vec3 center(std::size_t i) { return system.bodies().center_of_mass(members[i]); }
};

TEST(JointPose, of_an_arm_is_that_of_its_forward_kinematics) {
  for (const double first : {-1.5, 0.3, 1.9})
    for (const double second : {-1.9, 0.4, 1.2}) {
      Arm arm;
      arm.system.joints().set_value(arm.hinges[0], JointCoordinate::angle, first);
      arm.system.joints().set_value(arm.hinges[1], JointCoordinate::angle, second);
      const Vec3 along{std::cos(first), std::sin(first), 0},
          beyond{std::cos(first + second), std::sin(first + second), 0};
      EXPECT_LT(norm(arm.center(0) - 0.5 * along), 1e-12);
      EXPECT_LT(norm(arm.center(1) - (along + 0.5 * beyond)), 1e-12);
      EXPECT_EQ(arm.system.step(1.0 / 60).unconverged, 0);
      EXPECT_LT(norm(arm.center(1) - (along + 0.5 * beyond)), 1e-9) << "it stays there";
    }
}

TEST(JointPose, beyond_a_limit_is_refused_and_nothing_moves) {
  Arm arm;
  const std::uint64_t before = arm.system.state_hash();
  EXPECT_THROW(arm.system.joints().set_value(arm.hinges[0], JointCoordinate::angle, 2.5), std::invalid_argument);
  EXPECT_THROW(arm.system.joints().set_value(arm.hinges[0], JointCoordinate::slide, 0.1), std::invalid_argument);
  EXPECT_EQ(arm.system.state_hash(), before);
}

/// In a loop the rest of the mechanism follows: with a rod from the arm's end to the world, of three members of 1 m on a base of
/// 1 m, the angle between the two members of the arm closes as that of a rhombus does.
TEST(JointPose, in_a_loop_takes_the_other_members_along) {
  Arm arm;
  System& system = arm.system;
  arm.system.joints().set_value(arm.hinges[0], JointCoordinate::angle, std::numbers::pi / 2);
  arm.system.joints().set_value(arm.hinges[1], JointCoordinate::angle, -std::numbers::pi / 2);
  const ParticleId tip = system.bodies().create_attachment(arm.members[1], {1, 1, 0});
  const ParticleId foot = system.particles().create(system.bodies().create(), {1, 0, 0});
  system.particles().nail(foot);
  (void)system.joints().create(DistanceSpec{.p = tip, .q = foot});
  constexpr double angle = 1.2;
  system.joints().set_value(arm.hinges[0], JointCoordinate::angle, angle);
  const Vec3 along{std::cos(angle), std::sin(angle), 0};
  EXPECT_LT(norm(arm.center(0) - 0.5 * along), 1e-7);
  EXPECT_LT(norm(system.particles().position(tip) - (along + Vec3{1, 0, 0})), 1e-6) << "opposite sides stay parallel";
  EXPECT_NEAR(norm(system.particles().position(tip) - Vec3{1, 0, 0}), 1, 1e-9);
}

}  // namespace
}  // namespace iota
