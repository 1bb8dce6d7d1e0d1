// SPDX-License-Identifier: Apache-2.0
#include "contact/rims.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

constexpr double radius = 0.2, sixth = std::numbers::pi / 3;

std::vector<Touch> hexagon() {
  std::vector<Touch> touches(6);
  for (std::uint32_t k = 0; k < touches.size(); ++k) {
    Touch& touch = touches[k];
    touch.feature = k, touch.normal = {0, 1, 0};
    touch.center = touch.place = {radius * std::cos(sixth * k), 0.001, -radius * std::sin(sixth * k)};
    touch.gap = 0.001;
    touch.rim = Rim{{0, 0.001, 0}, {radius, 0, 0}, {0, 0, -radius}, 1};
  }
  return touches;
}

Vec3 at(double share, double turn) { return {share * radius * std::cos(turn), 0, -share * radius * std::sin(turn)}; }

TEST(Rims, are_beside_a_load_out_of_the_hexagon) {
  const std::vector<Touch> touches = hexagon();
  std::vector<Touch> added;
  PointsOfRim points(touches, touches[0], added);
  points.add_beside(at(0.5, 0.3));
  EXPECT_TRUE(added.empty());
  points.add_beside(at(0.95, 0.3));
  ASSERT_EQ(added.size(), 2u);
  for (const Touch& touch : added) {
    EXPECT_NEAR(norm(touch.place - touch.rim->middle), radius, 1e-12);
    EXPECT_NEAR(touch.gap, 0.001, 1e-12);
    EXPECT_LT(norm(touch.place - touch.rim->middle - at(1, 0.3)), 0.066 * radius);
  }
  points.add_beside(at(0.9, 0.3)), points.add_again(added[0].feature), points.add_again(3);
  EXPECT_EQ(added.size(), 2u);
}

TEST(Rims, are_not_beyond_the_fixed_ones) {
  const std::vector<Touch> all = hexagon(), touches(all.begin(), all.begin() + 2);
  std::vector<Touch> added;
  PointsOfRim points(touches, touches[0], added);
  points.add_beside(at(1, 2));
  EXPECT_TRUE(added.empty());
  points.add_beside(at(1, 0.5));
  EXPECT_EQ(added.size(), 2u);
}

}  // namespace
}  // namespace iota::contact
