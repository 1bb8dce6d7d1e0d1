// SPDX-License-Identifier: Apache-2.0
#include "geometry/curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace iota::geometry {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Spline, through_a_circle_has_its_length_and_runs_at_unit_speed) {
  const auto circle =
      Spline::of_function([](double u) { return Vec3{2 * std::cos(u), 2 * std::sin(u), 0}; }, 0, 2 * pi, true, 40);
  EXPECT_NEAR(circle.length(), 4 * pi, 1e-4);
  for (int i = 0; i < 100; ++i) {
    const CurvePoint c = circle.at(0.3 * i);  // any number of rounds
    EXPECT_NEAR(norm(c.position), 2, 1e-4);
    EXPECT_NEAR(norm(c.d1), 1, 1e-4);
    EXPECT_NEAR(norm(c.d2), 0.5, 1e-2);
  }
}

TEST(Spline, passes_its_points_and_goes_on_straight_beyond_its_ends) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0.5, 0}, {2, 0, 1}, {2.5, 1, 1}};
  const Spline spline(points);
  for (const Vec3& p : points) EXPECT_NEAR(norm(spline.at(spline.nearest(p)).position - p), 0, 1e-9);
  const CurvePoint end = spline.at(spline.length()), beyond = spline.at(spline.length() + 0.5);
  EXPECT_NEAR(norm(beyond.position - end.position - 0.5 * end.d1), 0, 1e-12);
}

TEST(Polyline, rounds_its_corners_without_a_jump_of_the_tangent) {
  const Polyline line(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 1}}, false, 0.2);
  CurvePoint last = line.at(0);
  const double step = 1e-3;
  for (double s = step; s < line.length(); s += step) {
    const CurvePoint c = line.at(s);
    ASSERT_NEAR(norm(c.position - last.position), step, 1e-6);
    ASSERT_LT(norm(c.d1 - last.d1), 1.01 * step / 0.2) << "curvature is at most one over the radius";
    last = c;
  }
  EXPECT_LT(norm(last.position - Vec3{2, 1, 1}), 2 * step);
}

TEST(Polyline, refuses_points_that_are_no_curve) {
  EXPECT_THROW(Polyline(std::vector<Vec3>{{0, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(Polyline(std::vector<Vec3>{{1, 2, 3}, {1, 2, 3}}), std::invalid_argument);
  EXPECT_THROW(Polyline(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}), std::invalid_argument)
      << "turns back on itself";
  EXPECT_THROW(Polyline(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}, true), std::invalid_argument);
  EXPECT_THROW(Spline(std::vector<Vec3>{{0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}}),
               std::invalid_argument);
}

TEST(Curve, finds_the_nearest_place_that_brute_force_finds) {
  const auto knot = Spline::of_function(
      [](double u) {
        return Vec3{std::sin(u) + 2 * std::sin(2 * u), std::cos(u) - 2 * std::cos(2 * u), -std::sin(3 * u)};
      },
      0, 2 * pi, true);
  const Polyline line(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 1}, {0, 2, 0}});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-3, 3);
  for (const Curve* curve : {static_cast<const Curve*>(&knot), static_cast<const Curve*>(&line)})
    for (int round = 0; round < 100; ++round) {
      const Vec3 p{number(random), number(random), number(random)};
      double least = std::numeric_limits<double>::infinity();
      for (int i = 0; i <= 4000; ++i) least = std::min(least, norm(p - curve->at(curve->length() * i / 4000).position));
      ASSERT_LE(norm(p - curve->at(curve->nearest(p)).position), least + 1e-12);
    }
}

}  // namespace
}  // namespace iota::geometry
