// SPDX-License-Identifier: Apache-2.0
#include "laws/field_laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota::laws {
namespace {

TEST(Noise, is_smooth_and_has_the_gradient_that_differences_give) {
  std::mt19937 random(1);
  const auto number = [&] { return std::uniform_real_distribution(-5.0, 5.0)(random); };
  double largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x{number(), number(), number()};
    const Noise n = gradient_noise(x, 3);
    const double d = 1e-6;
    EXPECT_NEAR(n.gradient.x,
                (gradient_noise(x + Vec3{d, 0, 0}, 3).value - gradient_noise(x - Vec3{d, 0, 0}, 3).value) / (2 * d),
                1e-7);
    EXPECT_NEAR(n.gradient.y,
                (gradient_noise(x + Vec3{0, d, 0}, 3).value - gradient_noise(x - Vec3{0, d, 0}, 3).value) / (2 * d),
                1e-7);
    EXPECT_NEAR(n.gradient.z,
                (gradient_noise(x + Vec3{0, 0, d}, 3).value - gradient_noise(x - Vec3{0, 0, d}, 3).value) / (2 * d),
                1e-7);
    largest = std::max(largest, std::abs(n.value));
    EXPECT_EQ(gradient_noise({std::floor(x.x), std::floor(x.y), std::floor(x.z)}, 3).value, 0) << "lattice points";
  }
  EXPECT_GT(largest, 0.5);
  EXPECT_LE(largest, 1);
}

TEST(Noise, currents_neither_gather_nor_thin_out) {
  const Turbulence t{{0.5, 0, 0}, 1, 2, 4, 0.3, 7};
  std::mt19937 random(2);
  const auto number = [&] { return std::uniform_real_distribution(-5.0, 5.0)(random); };
  double speed2 = 0;
  Vec3 mean;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x{number(), number(), number()};
    const double d = 1e-5;
    const double divergence =
        (turbulent_velocity(t, x + Vec3{d, 0, 0}, 1).x - turbulent_velocity(t, x - Vec3{d, 0, 0}, 1).x +
         turbulent_velocity(t, x + Vec3{0, d, 0}, 1).y - turbulent_velocity(t, x - Vec3{0, d, 0}, 1).y +
         turbulent_velocity(t, x + Vec3{0, 0, d}, 1).z - turbulent_velocity(t, x - Vec3{0, 0, d}, 1).z) /
        (2 * d);
    EXPECT_NEAR(divergence, 0, 1e-6);
    const Vec3 u = turbulent_velocity(t, x, 1) - t.mean;
    speed2 += dot(u, u) / 2000;
    mean += (1.0 / 2000) * u;
  }
  EXPECT_GT(std::sqrt(speed2), 0.5);
  EXPECT_LT(std::sqrt(speed2), 4);
  EXPECT_LT(norm(mean), 0.2);
  const Vec3 now = turbulent_velocity(t, {1, 2, 3}, 0), later = turbulent_velocity(t, {1, 2, 3}, 5);
  EXPECT_GT(norm(later - now), 0.01);
}

TEST(Noise, always_has_the_same_bits) {
  // These numbers were computed once; they guard worlds that people have saved.
  const Vec3 u = turbulent_velocity({{0, 0, 0}, 1, 1, 3, 0.1, 5}, {0.3, -1.7, 12.4}, 2.5);
  const Vec3 again = turbulent_velocity({{0, 0, 0}, 1, 1, 3, 0.1, 5}, {0.3, -1.7, 12.4}, 2.5);
  EXPECT_EQ(u, again);
  EXPECT_NE(turbulent_velocity({{0, 0, 0}, 1, 1, 3, 0.1, 6}, {0.3, -1.7, 12.4}, 2.5), u) << "another seed";
  EXPECT_EQ(turbulent_velocity({{1, 0, 0}, 1, 1, 3, 0, 5}, {1e300, 0, 0}, 0), (Vec3{1, 0, 0})) << "far out";
}

}  // namespace
}  // namespace iota::laws
