// SPDX-License-Identifier: Apache-2.0
// Edges and sides at which parts of obstacles meet.
#include "contact/seams.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace iota::contact {
namespace {

/// The normals towards a body of its touches with obstacles, without seams.
std::vector<Vec3> normals_of(const Outline& body, const std::vector<Outline>& obstacles, double within,
                             bool is_first = false) {
  std::vector<TouchOfPart> touches;
  for (const Outline& obstacle : obstacles)
    for (const Touch& touch : is_first ? touches_of(obstacle, body, within) : touches_of(body, obstacle, within))
      touches.push_back({.touch = touch, .obstacle = &obstacle, .is_first = is_first});
  std::vector<Seam> seams;
  drop_seams(touches, 1, seams);
  std::vector<Vec3> normals;
  for (const TouchOfPart& each : touches) normals.push_back(each.normal);
  return normals;
}

/// A cube of 1 m whose upper face is at a height.
Outline tile(double x, double top = 0, std::uint32_t number = 7) {
  return placed(Box{{1, 1, 1}}, {x, top - 0.5, 0}, {}, number);
}

const Outline ball = placed(Sphere{0.5}, {0.4, 0.5, 0});  // 0.1 m from the seam of the tiles at 0 and 1

TEST(Seams, between_tiles_of_one_height_are_not_touched) {
  const std::vector<Vec3> normals = normals_of(ball, {tile(0), tile(1)}, 0.2);
  ASSERT_EQ(normals.size(), 1u);
  EXPECT_NEAR(norm(normals[0] - Vec3{0, 1, 0}), 0, 1e-12);
  EXPECT_EQ(normals_of(ball, {tile(1), tile(0)}, 0.2).size(), 1u) << "in any order";
  EXPECT_EQ(normals_of(ball, {tile(0), tile(1, -0.1)}, 0.3).size(), 1u) << "nor of a tile that is lower";
  EXPECT_EQ(normals_of(ball, {tile(0), tile(1.0001)}, 0.3).size(), 1u) << "nor across a narrow gap";
  for (const Vec3& normal : normals_of(placed(Sphere{0.5}, {0.5, 0.5, 0}), {tile(0), tile(1)}, 0.2))
    EXPECT_NEAR(norm(normal - Vec3{0, 1, 0}), 0, 1e-12) << "above it";
}

TEST(Seams, of_two_parts_of_one_obstacle_are_not_touched_whichever_comes_first) {
  Outline plank = tile(0);
  plank.solids.push_back(tile(1, 0, 8).solids[0]);
  EXPECT_EQ(normals_of(ball, {plank}, 0.2).size(), 1u);
  EXPECT_EQ(normals_of(ball, {plank}, 0.2, true).size(), 1u);
}

TEST(Seams, are_touched_where_a_tile_is_higher_or_apart) {
  EXPECT_EQ(normals_of(ball, {tile(0), tile(1, 1e-3)}, 0.2).size(), 2u) << "a step";
  EXPECT_EQ(normals_of(ball, {tile(0), tile(1.05)}, 0.2).size(), 2u) << "a gap";
}

TEST(Seams, are_none_in_corners_and_under_what_lies_across) {
  const Outline wall = placed(Box{{1, 4, 1}}, {1, 0, 0});
  EXPECT_EQ(normals_of(placed(Sphere{0.2}, {0.3, 0.2, 0}), {tile(0), wall}, 0.01).size(), 2u) << "floor and wall";
  const Outline board = placed(Box{{1, 0.1, 0.5}}, {0.5, 0.05, 0});
  EXPECT_EQ(normals_of(board, {tile(0), tile(1)}, 0.01).size(), 8u) << "four corners on each tile";
}

TEST(Seams, at_the_top_of_a_ramp_leave_the_touches_on_it) {
  const double tilt = 0.2;  // rad, down from the edge of the tile at x = 0.5
  const Quaternion turn{0, 0, -std::sin(tilt / 2), std::cos(tilt / 2)};
  const Outline ramp = placed(Box{{2, 1, 1}}, Vec3{0.5, 0, 0} + rotate(turn, {1, -0.5, 0}), turn);
  // A board that has tipped about the edge lies on the ramp.
  const Outline board = placed(Box{{1, 0.1, 0.5}}, Vec3{0.5, 0, 0} + rotate(turn, {0.2, 0.05, 0}), turn);
  EXPECT_EQ(normals_of(board, {ramp}, 1e-3).size(), 4u);
  EXPECT_GE(normals_of(board, {tile(0), ramp}, 1e-3).size(), 4u);
}

TEST(Seams, of_round_bodies_are_those_of_their_faces) {
  const Quaternion upright{0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  const Outline coin = placed(Cylinder{0.3, 0.1}, {0.1, 0.05, 0}, upright),
                wheel = placed(Torus{0.4, 0.1}, {0.4, 0.5, 0});
  for (const Outline& body : {coin, wheel})
    for (const Vec3& normal : normals_of(body, {tile(0), tile(1)}, 0.2))
      EXPECT_NEAR(norm(normal - Vec3{0, 1, 0}), 0, 1e-9);
}

}  // namespace
}  // namespace iota::contact
