// SPDX-License-Identifier: Apache-2.0
// What only Newton's method does; solver_test.cpp has what every solver does.
#include "tests/cpp/solver/general/given_equations.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace iota {
namespace {

TEST(NewtonRaphson, takes_the_shortest_step_where_the_jacobian_is_singular) {
  // x + y = 2 twice: a line of roots; the nearest to (3, 0) is (2.5, -0.5).
  Given problem{2, [](auto x, auto f) { f[0] = x[0] + x[1] - 2, f[1] = 2 * f[0]; },
                [](auto, auto j) { j[0] = j[1] = 1, j[2] = j[3] = 2; }};
  std::vector<double> x{3, 0};
  EXPECT_TRUE(make_solver("newton")->solve(problem, x).converged);
  EXPECT_NEAR(x[0], 2.5, 1e-12);
  EXPECT_NEAR(x[1], -0.5, 1e-12);
}

TEST(NewtonRaphson, says_that_it_stands_at_a_minimum_of_the_size_and_no_root) {
  Given problem = cube_roots_of_one();
  std::vector<double> x{0, 0};  // f' = 0
  const SolverReport report = make_solver("newton")->solve(problem, x);
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.reason.find("minimum"), std::string::npos) << report.reason;
}

}  // namespace
}  // namespace iota
