// SPDX-License-Identifier: Apache-2.0
#include "solver/pieces.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

namespace iota::solver {
namespace {

using Numbers = std::vector<std::uint32_t>;

TEST(Pieces, are_connected_by_rows_or_by_rows_and_forces) {
  Problem problem;
  for (int i = 0; i < 5; ++i) add_point(problem, {static_cast<double>(i), 0, 0});
  (void)add_rod(problem, 3, 0, 3), (void)add_rod(problem, 1, 4, 3);
  add_spring(problem, 0, 1, 10, 1);
  Pieces pieces;
  EXPECT_EQ(find_pieces(problem, Connection::rows, pieces), 3u);
  EXPECT_EQ(pieces.of, (Numbers{0, 1, 2, 0, 1})) << "numbered by their lowest nodes";
  EXPECT_EQ(find_pieces(problem, Connection::rows_and_forces, pieces), 2u);
  EXPECT_EQ(pieces.of, (Numbers{0, 0, 1, 0, 0}));
}

/// How each piece is held.
std::vector<Holds> holds_of(const Problem& problem, Connection connection, const Pieces& pieces, std::uint32_t count) {
  std::vector<Holds> holds(count);
  add_holds(problem, connection, pieces, [&](std::uint32_t piece) -> Holds& { return holds[piece]; });
  return holds;
}

TEST(Pieces, that_hang_on_one_nail_are_not_connected_by_it_and_turn_about_it) {
  Problem problem;
  for (int i = 0; i < 5; ++i) add_point(problem, {static_cast<double>(i), 1, 0});
  nail(problem, 2);
  (void)add_rod(problem, 2, 0, 2), (void)add_rod(problem, 3, 4, 1), (void)add_rod(problem, 2, 3, 1);
  (void)add_rod(problem, 2, 4, 2);  // a second row of the same piece
  problem.mass_couplings.push_back({.a = 2, .b = 0, .mass = 0.1});
  add_spring(problem, 1, 2, 10, 1);
  Pieces pieces;
  ASSERT_EQ(find_pieces(problem, Connection::rows, pieces), 4u);
  EXPECT_EQ(pieces.of, (Numbers{0, 1, 2, 3, 3}));
  EXPECT_EQ(pieces.are_nails, (std::vector<std::uint8_t>{0, 0, 1, 0}));
  EXPECT_EQ(pieces.of_all(Numbers{2, 4}), 3u);
  EXPECT_EQ(pieces.of_all(Numbers{0, 2, 4}), Pieces::none);
  EXPECT_EQ(pieces.of_all(Numbers{2}), Pieces::none);
  for (const std::uint32_t piece : {0, 3})
    EXPECT_EQ(holds_of(problem, Connection::rows, pieces, 4)[piece].pivot(), (Vec3{2, 1, 0})) << piece;
  EXPECT_TRUE(holds_of(problem, Connection::rows, pieces, 4)[1].are_none());
  EXPECT_FALSE(holds_of(problem, Connection::rows, pieces, 4)[2].pivot()) << "the nail turns about nothing";

  ASSERT_EQ(find_pieces(problem, Connection::rows_and_forces, pieces), 4u);
  EXPECT_EQ(holds_of(problem, Connection::rows_and_forces, pieces, 4)[1].pivot(), (Vec3{2, 1, 0})) << "by its spring";
  EXPECT_EQ(find_pieces(problem, Connection::lengths, pieces), 2u) << "bodies that share points are together";

  problem.items_of<AffineConstraint>()[0].target_start = {2, 1, 0.1};
  EXPECT_EQ(holds_of(problem, Connection::rows_and_forces, pieces, 4)[0].count, 1);
  EXPECT_FALSE(holds_of(problem, Connection::rows_and_forces, pieces, 4)[0].pivot()) << "the nail moves";
}

TEST(Pieces, have_the_nails_on_which_nothing_else_hangs) {
  Problem problem;
  for (int i = 0; i < 5; ++i) add_point(problem, {static_cast<double>(i), 0, 0});
  for (const std::uint32_t node : {0u, 1u, 4u}) nail(problem, node);
  (void)add_rod(problem, 0, 1, 1), (void)add_rod(problem, 1, 2, 1), (void)add_rod(problem, 2, 3, 1);
  Pieces pieces;
  ASSERT_EQ(find_pieces(problem, Connection::rows, pieces), 2u);
  EXPECT_EQ(pieces.of, (Numbers{0, 0, 0, 0, 1})) << "nails that are connected go with what hangs on one of them";
  EXPECT_TRUE(pieces.are_nails.empty());
  EXPECT_EQ(holds_of(problem, Connection::rows, pieces, 2)[0].count, 2);
  EXPECT_EQ(holds_of(problem, Connection::rows, pieces, 2)[1].pivot(), (Vec3{4, 0, 0}));
}

/// A rod whose first end is tied to the middle of two nails, which are as the points of a static body.
TEST(Pieces, that_a_ball_joint_with_a_static_body_holds_turn_about_its_ball_if_nails_are_apart) {
  Problem problem;
  for (int i = 0; i < 4; ++i) add_point(problem, {static_cast<double>(i), 0, 0});
  nail(problem, 0), nail(problem, 2);
  (void)add_rod(problem, 1, 3, 2);
  AffineConstraint ball{.nodes = {0, 2, 1}, .weights = {0.5, 0.5, -1}, .count = 3};
  add(problem, ball);
  Pieces pieces;
  RoomForPieces room;
  EXPECT_EQ(find_pieces(problem, Connection::rows, pieces, room), 1u);
  EXPECT_EQ(find_pieces(problem, Connection::rows, pieces, room, Nails::apart), 2u);
  EXPECT_EQ(pieces.of, (Numbers{0, 1, 0, 1}));
  EXPECT_EQ(holds_of(problem, Connection::rows, pieces, 2)[1].pivot(), (Vec3{1, 0, 0}));

  AffineConstraint direction{.nodes = {0, 2, 1, 3}, .weights = {1, -1, -1, 1}, .count = 4};
  add(problem, direction);
  EXPECT_FALSE(holds_of(problem, Connection::rows, pieces, 2)[1].pivot()) << "a direction is held, too";
}

TEST(Pieces, between_two_nails_that_others_share_have_no_pivot) {
  Problem problem;
  for (int i = 0; i < 4; ++i) add_point(problem, {static_cast<double>(i), 0, 0});
  for (const std::uint32_t node : {0u, 3u}) nail(problem, node);
  (void)add_rod(problem, 0, 1, 1), (void)add_rod(problem, 1, 3, 2), (void)add_rod(problem, 0, 2, 2),
      (void)add_rod(problem, 2, 3, 1);
  Pieces pieces;
  ASSERT_EQ(find_pieces(problem, Connection::rows, pieces), 4u);
  for (const std::uint32_t piece : {1, 2})
    EXPECT_EQ(holds_of(problem, Connection::rows, pieces, 4)[piece].count, 2) << piece;
}

}  // namespace
}  // namespace iota::solver
