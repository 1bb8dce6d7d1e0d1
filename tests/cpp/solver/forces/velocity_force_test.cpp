// SPDX-License-Identifier: Apache-2.0
#include "solver/forces/force_list.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota::solver {
namespace {

VelocityForce random_force(unsigned seed, double h) {
  std::mt19937 random(seed);
  const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  Mat3 rate;
  for (auto& row : rate.m)
    for (double& value : row) value = 30 * number();
  VelocityForce force;
  force.arm.nodes = {0, 1}, force.arm.weights = {0.4, 0.6}, force.arm.count = 2;
  force.part = {rate, 0.7};
  const Vec3 velocities[] = {{number(), number(), number()}, {number(), number(), number()}};
  force.begin(velocities, h);
  return force;
}

constexpr ForceStage stages[] = {{.h = 0.02, .midpoint = true}, {.h = 0.02, .midpoint = false}};

TEST(VelocityForce, has_the_stiffness_that_differences_give) {
  const Vec3 e0{0.1, 0.2, 0.3}, e1{0.15, 0.17, 0.31};
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const ForceStage& stage : stages) {
      const VelocityForce f = random_force(seed, stage.h);
      const Mat3 k = f.stiffness_matrix(e0, e1, stage);
      const std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
      for (int c = 0; c < 3; ++c) {
        const double step = 1e-3;  // it is linear
        const Vec3 slope =
            (-0.5 / step) * (f.force(e0, e1 + step * axes[c], stage) - f.force(e0, e1 - step * axes[c], stage));
        for (int r = 0; r < 3; ++r) EXPECT_NEAR(k.m[r][c], dot(axes[r], slope), 1e-8 * (1 + norm(slope)));
      }
    }
}

TEST(VelocityForce, does_the_work_of_its_drag_alone) {
  const Vec3 e0{0.1, 0.2, 0.3}, e1{0.15, 0.17, 0.31};
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const ForceStage& stage : stages) {
      VelocityForce f = random_force(seed, stage.h);
      const double all = f.work(e0, e1, stage);
      f.part.turning = {};
      EXPECT_NEAR(f.work(e0, e1, stage), all, 1e-12 * (1 + std::abs(all)));
      f.part.drag = f.part.drag_at_end = {}, f.part.turning = {1, 2, 3};
      EXPECT_NEAR(f.work(e0, e1, stage), 0, 1e-14);
    }
}

TEST(VelocityPart, makes_the_drag_of_a_free_particle_exact_at_any_size) {
  for (const double drag : {1e-6, 0.5, 3.0, 1e4, 1e12, -20.0}) {  // a negative one drives
    const double mass = 0.3, h = 0.01, steady = 2;
    laws::VelocityPart part(Mat3::diagonal(-drag), mass);
    part.begin(h);
    const Vec3 before{5, -1, 0}, force = (drag * steady) * Vec3{1, 0, 0};
    const Vec3 gained = solve(Mat3::diagonal(1) + (-h / mass) * part.rate(), (h / mass) * (force - drag * before));
    const double left = std::exp(-drag * h / mass);
    const Vec3 exact = Vec3{steady, 0, 0} + left * (before - Vec3{steady, 0, 0});
    EXPECT_LT(norm(before + gained - exact), 1e-11 * (1 + left)) << drag;
  }
}

TEST(VelocityPart, of_a_matrix_is_that_of_its_axes) {
  std::mt19937 random(3);
  const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  for (int i = 0; i < 20; ++i) {
    const Quaternion q = turn_by({number(), number(), number()});
    const Vec3 axes[] = {rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1})};
    const double values[] = {-40, 7 * number(), 0};
    Mat3 s, wanted;
    for (int k = 0; k < 3; ++k) {
      s += values[k] * Mat3::outer(axes[k], axes[k]);
      wanted += values[k] * laws::VelocityPart::theta(0.2 * values[k] + (k == 2)) * Mat3::outer(axes[k], axes[k]);
    }
    const Mat3 found = laws::VelocityPart::weighted_by_theta(s, 0.2);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.m[r][c], wanted.m[r][c], 1e-12);
  }
}

}  // namespace
}  // namespace iota::solver
