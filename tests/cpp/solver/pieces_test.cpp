// SPDX-License-Identifier: Apache-2.0
#include "solver/pieces.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

namespace iota::solver {
namespace {

TEST(Pieces, are_connected_by_rows_or_by_rows_and_forces) {
  Problem problem;
  for (int i = 0; i < 5; ++i) add_point(problem, {static_cast<double>(i), 0, 0});
  (void)add_rod(problem, 3, 0, 3), (void)add_rod(problem, 1, 4, 3);
  add_spring(problem, 0, 1, 10, 1);
  std::vector<std::uint32_t> piece_of;
  EXPECT_EQ(find_pieces(problem, Connection::rows, piece_of), 3u);
  EXPECT_EQ(piece_of, (std::vector<std::uint32_t>{0, 1, 2, 0, 1})) << "numbered by their lowest nodes";
  EXPECT_EQ(find_pieces(problem, Connection::rows_and_forces, piece_of), 2u);
  EXPECT_EQ(piece_of, (std::vector<std::uint32_t>{0, 0, 1, 0, 0}));
}

}  // namespace
}  // namespace iota::solver
