// SPDX-License-Identifier: Apache-2.0
#include "solver/integrator.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

namespace iota::solver {
namespace {

/// A net of rods nailed at its corners, taut, with 100 kg in its middle: a step of hundreds of iterations.
Problem taut_net(double knot) {
  constexpr std::uint32_t side = 12;
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j)
      (void)add_point(problem, {0.1 * i, 0, 0.1 * j}, i == side / 2 && j == side / 2 ? 100 : knot);
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
  Problem problem = taut_net(0.01);
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

/// In worlds that people edit, that was the deadline of a step that was long ago: bodies were left apart.
TEST(StepBudget, of_a_step_does_not_bound_the_projections_after_it) {
  Problem problem = taut_net(0.1);
  Integrator integrator;
  integrator.compile(problem);
  IntegratorSettings settings = IntegratorSettings::energy_keeping();
  settings.deadline = std::chrono::steady_clock::now();
  EXPECT_TRUE(integrator.advance(problem, 1.0 / 60, settings).cut_short) << "or the scene is no test";
  problem.position[17] += Vec3{0.02, 0.01, 0};
  EXPECT_TRUE(integrator.project_positions(problem));
  EXPECT_LT(problem.worst_gap(problem.position.data()), 1e-9);
}

/// In steps of 1/60 s after the first, which finds the shape.
struct Costs {
  int usual = 0;      ///< median of their iterations
  int cut_short = 0;  ///< steps that needed more than `budget`, with the solves that close gaps
};
Costs costs_of_steps(Problem problem, int steps, IntegratorSettings settings, int budget = 0) {
  Integrator integrator;
  integrator.compile(problem);
  (void)integrator.advance(problem, 1.0 / 60, settings);
  settings.max_iterations = budget;
  Costs costs;
  std::vector<int> iterations;
  for (int step = 0; step < steps; ++step) {
    const AdvanceReport report = integrator.advance(problem, 1.0 / 60, settings);
    iterations.push_back(report.iterations), costs.cut_short += report.cut_short;
  }
  const auto middle = iterations.begin() + steps / 2;
  std::nth_element(iterations.begin(), middle, iterations.end());
  costs.usual = *middle;
  return costs;
}
void expect_steady(const Problem& problem, int steps) {
  for (const auto& settings : {IntegratorSettings::robust(), IntegratorSettings::energy_keeping()}) {
    const int usual = 1 + costs_of_steps(problem, steps, settings).usual;  // and an evaluation of the equations
    EXPECT_EQ(costs_of_steps(problem, steps, settings, 10 * usual).cut_short, 0) << "usual: " << usual;
  }
}

/// Its hardest steps took ten usual ones, of 39 iterations each, while the net threw its load up and down.
TEST(StepCost, of_a_load_that_falls_into_a_taut_net_is_below_three_hundred_iterations) {
  constexpr int steps = 40;
  const IntegratorSettings robust = IntegratorSettings::robust(), keeping = IntegratorSettings::energy_keeping();
  const int usual = costs_of_steps(taut_net(0.01), steps, robust).usual;
  EXPECT_EQ(costs_of_steps(taut_net(0.01), steps, robust, 10 * usual).cut_short, 0) << "usual: " << usual;
  EXPECT_EQ(costs_of_steps(taut_net(0.01), steps, keeping, 300).cut_short, 0);
  EXPECT_LE(costs_of_steps(taut_net(0.01), steps, keeping).usual, 20);
}

/// It took 200 iterations, whose steps beside saddles were a small part of the way to go.
TEST(StepCost, of_cloth_that_buckles_is_below_a_hundred_iterations) {
  constexpr std::uint32_t side = 32;
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j) (void)add_point(problem, {1.0 * i / side, 2, 1.0 * j / side}, 1e-3);
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j)
      for (const auto& [x, y] : {std::pair{i + 1, j}, {i, j + 1}, {i + 1, j + 1}})
        if (x < side && y < side) {
          const std::uint32_t p = side * i + j, q = side * x + y;
          add_spring(problem, p, q, 1e4, norm(problem.position[q] - problem.position[p]));
        }
  nail(problem, 0), nail(problem, side * (side - 1));
  EXPECT_EQ(costs_of_steps(problem, 40, IntegratorSettings::robust(), 100).cut_short, 0);
}

TEST(StepCost, of_an_unchanged_conflict_stays_below_ten_usual_steps) {
  for (const std::uint32_t links : {2u, 20u, 100u}) {  // of 1 m in all, between nails 1.5 m apart
    Problem problem;
    problem.gravity = {0, -9.81, 0};
    for (std::uint32_t i = 0; i <= links; ++i) (void)add_point(problem, {1.5 * i / links, 0, 0}, 0.1 / links);
    for (std::uint32_t i = 0; i < links; ++i) (void)add_rod(problem, i, i + 1, 1.0 / links);
    nail(problem, 0), nail(problem, links);
    expect_steady(problem, 300);
  }
}

}  // namespace
}  // namespace iota::solver
