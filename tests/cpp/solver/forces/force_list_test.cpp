// SPDX-License-Identifier: Apache-2.0
#include "solver/forces/force_list.h"

#include <gtest/gtest.h>

namespace iota::solver {
namespace {

ForceArm between_two_points() {
  ForceArm arm;
  arm.nodes = {0, 1}, arm.weights = {-1, 1}, arm.count = 2;
  return arm;
}

template <class F>
F late(F f) {
  const Vec3 velocities[2] = {{0.3, -0.2, 0.1}, {-1, 0.4, 0.7}};
  const double masses[2] = {0.5, 2};
  f.arm = between_two_points();
  f.begin(velocities, masses, 0.01);
  return f;
}

template <class F>
void expect_stiffness_of_differences(const F& f) {
  constexpr double h = 0.01, d = 1e-6;
  const ForceStage stage{.h = h, .midpoint = true};
  const Vec3 e0{0.5, 0.2, -0.1}, e1{0.49, 0.22, -0.09};
  const Mat3 k = f.stiffness_matrix(e0, e1, stage);
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 slope = (1 / (2 * d)) * (f.force(e0, e1 - d * axis, stage) - f.force(e0, e1 + d * axis, stage));
    EXPECT_LT(norm(k * axis - slope), 1e-6 * (norm(slope) + 1));
  }
}

TEST(LateDashpot, has_the_stiffness_that_differences_give) {
  SpringForce spring;
  spring.stiffness = 30, spring.damping = 500, spring.length = 0.4;
  spring = late(spring);
  EXPECT_GT(spring.late, 0);
  expect_stiffness_of_differences(spring);
  DragForce drag;
  drag.damping = 500;
  expect_stiffness_of_differences(late(drag));
}

TEST(LateDashpot, stops_two_free_masses_within_a_step_however_strong_it_is) {
  for (const double damping : {400.0, 1e4, 1e9}) {  // of 1/h times their reduced mass
    DragForce drag;
    drag.damping = damping;
    drag = late(drag);
    constexpr double h = 0.01, reduced = 0.4;
    const Vec3 e0{1, 0, 0}, e1 = e0 + (0.5 * h) * drag.start;  // to rest: the mean rate is half of the first
    const Vec3 impulse = h * drag.force(e0, e1, {.h = h, .midpoint = true});
    EXPECT_LT(norm(impulse + reduced * drag.start), 1e-9 * norm(drag.start) * damping / 400);
  }
}

TEST(LateDashpot, is_a_plain_one_where_it_does_not_stop_what_it_holds) {
  DragForce drag;
  drag.damping = 70;
  EXPECT_EQ(late(drag).late, 0);
}

}  // namespace
}  // namespace iota::solver
