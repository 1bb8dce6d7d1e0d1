// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_readings.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace iota {
namespace {

constexpr auto angle = static_cast<std::size_t>(JointCoordinate::angle);
constexpr auto slide = static_cast<std::size_t>(JointCoordinate::slide);

TEST(JointReadings, count_an_angle_through_full_turns_and_both_ways) {
  for (const double speed : {20.0, -20.0}) {
    System system{SystemOptions{.gravity = {}}};
    const BodyId wheel = system.bodies().create(Cylinder{}, {.spin = {speed, 0, 0}});
    const ConstraintId axle =
        system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = wheel, .axis = {2, 0, 0}});
    for (int i = 0; i < 100; ++i) (void)system.step(0.01);
    const ConstraintState state = system.joints().state(axle);
    EXPECT_NEAR(state.speed[angle], speed, 1e-6);
    EXPECT_NEAR(state.coordinate[angle], speed, 0.02 * 20) << "20 rad in 1 s, more than three turns";
    EXPECT_LT(norm(state.axis - Vec3{1, 0, 0}), 1e-12) << "a unit vector";
  }
}

TEST(JointReadings, have_a_slide_in_meters_along_the_axis_of_the_second_body) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId slider = system.bodies().create(Box{}, {.position = {1, 1, 1}, .velocity = {0, 3, 0}});
  const ConstraintId rail = system.joints().create(
      JointSpec{.kind = ConstraintKind::prismatic, .a = slider, .at = {1, 1, 1}, .axis = {0, 5, 0}});
  for (int i = 0; i < 10; ++i) (void)system.step(0.05);
  const ConstraintState state = system.joints().state(rail);
  EXPECT_NEAR(state.coordinate[slide], 1.5, 1e-9);
  EXPECT_NEAR(state.speed[slide], 3, 1e-9);
  EXPECT_LT(norm(state.position - Vec3{1, 2.5, 1}), 1e-9);
}

TEST(JointReadings, of_a_cantilever_are_its_weight_and_the_moment_of_that) {
  System system;
  const BodyId beam = system.bodies().create(Box{{2, 0.1, 0.1}}, {.mass = 3, .position = {1, 0, 0}});
  const ConstraintId weld = system.joints().create(JointSpec{.kind = ConstraintKind::weld, .a = beam, .at = {}});
  for (int i = 0; i < 5; ++i) (void)system.step(0.01);
  const ConstraintState state = system.joints().state(weld);
  const double weight = 3 * 9.81;
  EXPECT_LT(norm(state.force - Vec3{0, weight, 0}), 1e-5 * weight);
  EXPECT_LT(norm(state.torque - Vec3{0, 0, weight}), 1e-4 * weight) << "about the wall, at a lever of 1 m";
  EXPECT_LT(state.gap, 1e-9);
}

}  // namespace
}  // namespace iota
