// SPDX-License-Identifier: Apache-2.0
#include "solver/forces/force_list.h"

#include <gtest/gtest.h>

#include <random>

namespace iota::solver {
namespace {

/// A vector that turns without changing its length, and the force of a spin along it.
struct Turning {
  explicit Turning(unsigned seed) {
    std::mt19937 random(seed);
    const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
    e0 = {number(), number(), number()};
    const Vec3 other{number(), number(), number()};
    e1 = (norm(e0) / norm(e0 + 0.3 * other)) * (e0 + 0.3 * other);
    force.spin = 1.7 * number();
  }
  GyroscopicForce force;
  Vec3 e0, e1;
  ForceStage stage{0.02, true, false};
};

TEST(GyroscopicForce, has_the_stiffness_that_differences_give) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Turning t(seed);
    const Mat3 k = t.force.stiffness_matrix(t.e0, t.e1, t.stage);
    const std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int c = 0; c < 3; ++c) {
      const double step = 1e-6;
      const Vec3 slope = (-0.5 / step) * (t.force.force(t.e0, t.e1 + step * axes[c], t.stage) -
                                          t.force.force(t.e0, t.e1 - step * axes[c], t.stage));
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(k.m[r][c], dot(axes[r], slope), 1e-6 * (1 + norm(slope)));
    }
  }
}

TEST(GyroscopicForce, does_no_work_and_its_moment_is_the_loss_of_spin) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Turning t(seed);
    const Vec3 force = t.force.force(t.e0, t.e1, t.stage);
    EXPECT_NEAR(dot(force, t.e1 - t.e0), 0, 1e-12);
    const Vec3 moment = t.stage.h * cross(0.5 * (t.e0 + t.e1), force) + t.force.spin * (t.e1 - t.e0);
    EXPECT_NEAR(norm(moment), 0, 1e-14);
  }
}

}  // namespace
}  // namespace iota::solver
