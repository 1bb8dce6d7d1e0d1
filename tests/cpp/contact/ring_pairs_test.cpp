// SPDX-License-Identifier: Apache-2.0
// Rings against each other and against rods, by many points of their middle lines.
#include "contact/ring_pairs.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::contact {
namespace {

double sampled_distance(const auto& first, const auto& second, int count) {
  double least = 1e300;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < count; ++k) least = std::min(least, norm(first(i / (count - 1.0)) - second(k / (count - 1.0))));
  return least;
}

TEST(RingPairs, have_points_of_their_middle_line_at_equal_ways) {
  const Outline outline = placed(Torus{0.2, 0.03, 0.5}, {});
  const Ring ring = make_ring(outline.solids[0], {});
  for (int k = 0; k < 1000; ++k) {
    const Vec3 point = ring.point(k / 1000.0), next = ring.point((k + 1) / 1000.0);
    EXPECT_NEAR(norm(next - point), ring.length() / 1000, 1e-6);
    EXPECT_NEAR(norm(ring.nearest(point) - point), 0, 1e-12);
    EXPECT_GT(dot(ring.tangent(point), next - point), 0.99 * norm(next - point));
  }
}

TEST(RingPairs, have_the_gap_of_their_distance) {
  RandomShapes random(11);
  int count = 0;
  for (int round = 0; round < 100; ++round) {
    const Torus link{0.2, 0.03, round % 2 ? 0.0 : 0.3};
    const Outline one = placed(link, random.vector(0.3), random.turn()), other = placed(link, {}, random.turn());
    const Outline rod = placed(Capsule{0.05, 1}, random.vector(0.3), random.turn());
    const Ring ring = make_ring(one.solids[0], {}), next = make_ring(other.solids[0], {});
    const Vec3 half = rotate(rod.solids[0].turn, {0.5, 0, 0});
    const auto on_rod = [&](double share) { return rod.solids[0].position + (2 * share - 1) * half; };
    const auto on_ring = [&](double share) { return ring.point(share); };
    const double of_rings = sampled_distance(on_ring, [&](double share) { return next.point(share); }, 300) - 0.06;
    const double of_rod = sampled_distance(on_ring, on_rod, 300) - 0.08;
    const auto touches = touches_of(one, other, 0.1), with_rod = touches_of(rod, one, 0.1),
               turned = touches_of(one, rod, 0.1);
    if (of_rings < 0.099 && of_rings > -0.05) {
      ++count;
      EXPECT_NEAR(least_gap_of(touches), of_rings, 2e-3);
    }
    if (of_rod < 0.099 && of_rod > -0.07) {
      ++count;
      EXPECT_NEAR(least_gap_of(with_rod), of_rod, 2e-3);
      EXPECT_NEAR(least_gap_of(turned), least_gap_of(with_rod), 1e-9);
    }
    for (const Touch& touch : touches)
      EXPECT_NEAR(dot(touch.normal, touch.center - touch.origin) - touch.radius, touch.gap, 1e-12);
  }
  EXPECT_GT(count, 50);
}

TEST(RingPairs, of_links_of_a_chain_touch_once_at_their_ends) {
  const Torus link{0.2, 0.03, 0.3};
  // The lower one hangs in the upper one, a quarter turn about the chain.
  const Outline upper = placed(link, {}, {}, 1),
                lower = placed(link, {-0.64, 0, 0}, axis_angle({1, 0, 0}, std::acos(0.0)), 2);
  const auto found = touches_of(lower, upper, 0.01);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(norm(found[0].normal - Vec3{1, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(found[0].gap, 0, 1e-12);
  EXPECT_EQ(found[0].form, TouchForm::wires);
}

TEST(RingPairs, that_cross_have_the_gap_of_their_distance_when_they_move_aside) {
  for (const double twist : {90.0, 75.0}) {  // degrees
    const Torus link{0.2, 0.03, 0.3};
    const Outline upper = placed(link, {}, {}, 1);
    const auto lower = [&](const Vec3& way) {
      return placed(link, Vec3{-0.64, 0, 0} + way, axis_angle({1, 0, 0}, twist * std::acos(0.0) / 90), 2);
    };
    const Touch touch = touches_of(lower({}), upper, 0.01).front();
    ASSERT_EQ(touch.form, TouchForm::wires);
    const Vec3 side = cross(touch.normal, touch.axis);
    for (const Vec3& way : {2e-3 * touch.axis, 2e-3 * side}) {
      const Vec3 d = touch.center - touch.origin + way;
      const double along = dot(touch.axis, d), beside = dot(side, d);
      const double gap =
          std::sqrt(dot(d, d) - touch.bends[0] * along * along - touch.bends[1] * beside * beside) - touch.radius;
      const double found = least_gap_of(touches_of(lower(way), upper, 0.01));
      EXPECT_LT(found, -1e-6);
      EXPECT_NEAR(gap, found, 0.02 * std::abs(found)) << twist;
    }
  }
}

TEST(RingPairs, that_lie_on_each_other_touch_all_around) {
  const auto found = touches_of(placed(Torus{0.2, 0.03}, {0, 0, 0.06}), placed(Torus{0.2, 0.03}, {}), 0.01);
  ASSERT_EQ(found.size(), 6u);
  for (const Touch& touch : found) EXPECT_NEAR(touch.gap, 0, 1e-12);
}

TEST(RingPairs, hang_on_a_rod) {
  const Outline rod = placed(Capsule{0.05, 1}, {}, axis_angle({0, 1, 0}, std::acos(0.0)));
  const auto found = touches_of(placed(Torus{0.2, 0.03}, {0, -0.12, 0}), rod, 0.01);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(norm(found[0].normal - Vec3{0, 1, 0}), 0, 1e-6);
  EXPECT_NEAR(found[0].gap, 0, 1e-12);
}

}  // namespace
}  // namespace iota::contact
