// SPDX-License-Identifier: Apache-2.0
// Times of approach against closed forms, and against the distances along the way.
#include "contact/approach.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace iota::contact {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

double time_of(const Outline& first, const Motion& a, const Outline& second, const Motion& b, double close,
               double latest) {
  TouchFinder touches;
  ApproachFinder approaches(touches);
  return approaches.time(first, a, second, b, close, latest);
}

TEST(Approach, of_two_balls_has_the_time_of_the_closed_form) {
  for (const double size : {1e-3, 1.0, 1e3})
    for (const double beside : {0.0, 0.3, 1.2, 1.9}) {
      const double speed = 100 * size, close = 1e-3 * size;
      const Vec3 at{7 * size, 2 * size, -3 * size}, start = at + Vec3{-20 * size, beside * size, 0};
      const Outline first = placed(Sphere{size}, start), second = placed(Sphere{size}, at);
      const double along = std::sqrt(4 * size * size - beside * beside * size * size);
      const double meets = (20 * size - along) / speed;
      const double found = time_of(first, {start, {0.75 * speed, 0, 0}, {}, size}, second,
                                   {at, {-0.25 * speed, 0, 0}, {}, size}, close, 1);
      EXPECT_LE(found, meets);
      EXPECT_GT(found, meets - 10 * close / speed - 1e-2 * meets) << size << " m, beside " << beside;
    }
}

TEST(Approach, of_what_passes_or_leaves_is_never) {
  const Outline wall = placed(Box{{2, 2, 0.01}}, {}), ball = placed(Sphere{0.1}, {1.2, 0, -3});
  EXPECT_EQ(time_of(ball, {{1.2, 0, -3}, {0, 0, 500}, {}, 0.1}, wall, {}, 1e-3, 0.1), never);
  EXPECT_EQ(time_of(ball, {{1.2, 0, -3}, {-200, 0, 20}, {}, 0.1}, wall, {}, 1e-3, 0.1), never);
  EXPECT_EQ(time_of(ball, {{1.2, 0, -3}, {-1, 0, -500}, {}, 0.1}, wall, {}, 1e-3, 0.1), never);
  EXPECT_EQ(time_of(ball, {{1.2, 0, -3}, {-0.5, 0, 10}, {}, 0.1}, wall, {}, 1e-3, 0.1), never) << "not in this time";
}

TEST(Approach, of_a_bar_that_turns_is_when_it_comes_round) {
  const Outline bar = placed(Box{{2, 0.02, 0.02}}, {}), post = placed(Sphere{0.05}, {0, 0.9, 0});
  const double rate = 30;
  const double meets = (std::numbers::pi / 2 - std::asin((0.05 + 0.01) / 0.9)) / rate;
  const double found = time_of(bar, {{}, {}, {0, 0, rate}, 1}, post, {{0, 0.9, 0}, {}, {}, 0.05}, 1e-3, 1);
  EXPECT_LE(found, meets);
  EXPECT_GT(found, 0.9 * meets);
}

TEST(Approach, is_not_late_for_random_outlines_in_either_order) {
  std::mt19937 random(5);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto vector = [&](double size) { return Vec3{number(-size, size), number(-size, size), number(-size, size)}; };
  const Shape shapes[] = {Sphere{0.3}, Box{{0.6, 0.4, 0.02}}, Capsule{0.1, 0.5}, Cylinder{0.03, 0.8},
                          Box{{2, 2, 0.05}}};
  int met = 0;
  for (int round = 0; round < 150; ++round) {
    const Vec3 start =
                   3.0 * rotate(normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)}), {0, 1, 0}),
               target = vector(0.5);
    const auto turn = [&] { return normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)}); };
    Outline first = placed(shapes[round % 5], start, turn()), second = placed(shapes[(round / 5) % 5], {}, turn());
    const Motion a{start, number(20, 200) * (target - start), vector(40), 2}, b{{}, vector(20), vector(10), 2};
    constexpr double latest = 0.1, close = 1e-3;
    const double found = time_of(first, a, second, b, close, latest);
    const double end = std::min(found, latest);
    EXPECT_NEAR(end, std::min(latest, time_of(second, b, first, a, close, latest)), 0.02 * latest) << round;
    met += found < latest;
    constexpr int places = 60;
    for (int k = 0; k < places; ++k) {
      const double t = end * k / places;
      const auto at = [&](Outline outline, const Motion& m) {
        for (Solid& solid : outline.solids) {
          solid.position = m.center + t * m.velocity + rotate(turn_by(t * m.spin), solid.position - m.center);
          solid.turn = multiply(turn_by(t * m.spin), solid.turn);
        }
        return outline;
      };
      const Outline one = at(first, a), other = at(second, b);
      EXPECT_GT(upper_distance(one.solids[0], other.solids[0]), 0) << round << ": they overlap before";
    }
  }
  EXPECT_GT(met, 30);
}

}  // namespace
}  // namespace iota::contact
