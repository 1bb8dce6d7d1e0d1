// SPDX-License-Identifier: Apache-2.0
#include "solver/integrator.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace iota::solver {
namespace {

/// A net of rods nailed at its corners, taut, with a heavy knot in its middle: a step of hundreds of iterations.
Problem taut_net() {
  constexpr std::uint32_t side = 12;
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j)
      (void)add_point(problem, {0.1 * i, 0, 0.1 * j}, i == side / 2 && j == side / 2 ? 100 : 0.1);
  for (const std::uint32_t corner : {0u, side - 1, side * (side - 1), side * side - 1}) nail(problem, corner);
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j) {
      if (i + 1 < side) (void)add_rod(problem, i * side + j, (i + 1) * side + j, 0.1);
      if (j + 1 < side) (void)add_rod(problem, i * side + j, i * side + j + 1, 0.1);
    }
  return problem;
}

/// The most iterations of a step.
int work_hardest(int budget) {
  Problem problem = taut_net();
  Integrator integrator;
  integrator.compile(problem);
  IntegratorSettings settings = IntegratorSettings::energy_keeping();
  settings.max_iterations = budget;
  int most = 0;
  for (int step = 0; step < 30; ++step) {
    const AdvanceReport report = integrator.advance(problem, 1.0 / 60, settings);
    most = std::max(most, report.iterations);
    for (const Vec3& x : problem.position) EXPECT_LT(norm(x), 100);
  }
  return most;
}

TEST(StepBudget, bounds_the_iterations_of_a_step) {
  EXPECT_GT(work_hardest(0), 60) << "or the scene is no test";
  for (const int budget : {1, 5, 20, 50})
    EXPECT_LE(work_hardest(budget), budget + IntegratorSettings::last_resort_iterations);
}

}  // namespace
}  // namespace iota::solver
