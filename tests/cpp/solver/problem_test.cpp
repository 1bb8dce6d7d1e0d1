// SPDX-License-Identifier: Apache-2.0
#include "solver/problem.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace iota::solver {
namespace {

// A gap that is not a number would otherwise look like no gap: a projection that has failed was taken for one that has
// closed everything.
TEST(Problem, a_gap_that_is_not_a_number_is_the_largest) {
  Problem problem = zigzag(3);
  ASSERT_LT(problem.worst_gap(problem.position.data()), 1e-12);
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    const Vec3 place = problem.position[node];
    problem.position[node].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(problem.worst_gap(problem.position.data()))) << "node " << node;
    EXPECT_TRUE(std::isinf(problem.worst_gap(problem.position.data(), 0, true))) << "node " << node;
    problem.position[node] = place;
  }
}

}  // namespace
}  // namespace iota::solver
