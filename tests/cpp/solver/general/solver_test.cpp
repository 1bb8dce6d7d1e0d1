// SPDX-License-Identifier: Apache-2.0
#include "tests/cpp/solver/general/given_equations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace iota {
namespace {

// Every test below holds for each solver that this build has.
class AnySolver : public testing::TestWithParam<std::string> {
 protected:
  SolverReport solve(NonlinearProblem& problem, std::vector<double>& x, SolverOptions options = {}) {
    return make_solver(GetParam())->solve(problem, x, options);
  }
};
INSTANTIATE_TEST_SUITE_P(ByName, AnySolver, testing::ValuesIn(solver_names()),
                         [](const auto& info) { return info.param; });

TEST_P(AnySolver, finds_the_minimum_of_rosenbrocks_valley_from_where_newton_alone_overshoots) {
  Given problem = rosenbrock();
  std::vector<double> x{-1.2, 1};
  const SolverReport report = solve(problem, x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_NEAR(x[0], 1, 1e-9);
  EXPECT_NEAR(x[1], 1, 1e-9);
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_GT(report.iterations, 0);
}

TEST_P(AnySolver, solves_powells_badly_scaled_equations) {
  Given problem{
      2, [](auto x, auto f) { f[0] = 1e4 * x[0] * x[1] - 1, f[1] = std::exp(-x[0]) + std::exp(-x[1]) - 1.0001; }};
  std::vector<double> x{0, 1};
  const SolverReport report = solve(problem, x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_NEAR(x[0] / 1.098159e-5, 1, 1e-5);  // More, Garbow and Hillstrom 1981, problem 3
  EXPECT_NEAR(x[1] / 9.106146, 1, 1e-5);
}

TEST_P(AnySolver, finds_a_cube_root_of_one_from_nearly_everywhere) {
  Given problem = cube_roots_of_one();
  int found = 0, tried = 0;
  for (int i = -6; i <= 6; ++i)
    for (int k = -6; k <= 6; ++k) {
      std::vector<double> x{0.31 * i + 0.01, 0.29 * k + 0.02};
      ++tried;
      if (!solve(problem, x).converged) continue;
      ++found;
      const double angle = std::atan2(x[1], x[0]) / (2 * std::numbers::pi / 3);
      EXPECT_NEAR(std::hypot(x[0], x[1]), 1, 1e-9);
      EXPECT_NEAR(angle, std::round(angle), 1e-9);
    }
  EXPECT_GE(found, 0.97 * tried) << "the line search can end where |f| has a minimum on its way";
}

TEST_P(AnySolver, needs_no_jacobian) {
  Given exact = rosenbrock(), differences{2, exact.f};
  std::vector<double> x{-1.2, 1};
  const SolverReport report = solve(differences, x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_GT(report.evaluations, 2 * report.iterations) << "differences count as evaluations";
}

TEST_P(AnySolver, solves_linear_equations_at_once) {
  Given problem{
      3, [](auto x, auto f) { f[0] = 2 * x[0] + x[1] - 3, f[1] = x[0] - x[1] + x[2], f[2] = 4 * x[2] - x[0] - 2; }};
  std::vector<double> x{0, 0, 0};
  const SolverReport report = solve(problem, x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_LE(report.iterations, 3);
}

TEST_P(AnySolver, says_so_where_there_is_no_root) {
  Given problem{1, [](auto x, auto f) { f[0] = x[0] * x[0] + 1; }};
  std::vector<double> x{3};
  const SolverReport report = solve(problem, x);
  EXPECT_FALSE(report.converged);
  EXPECT_GE(report.residual, 1);
  EXPECT_FALSE(report.reason.empty());
  EXPECT_TRUE(std::isfinite(x[0]));
}

TEST_P(AnySolver, passes_exceptions_of_the_equations_on_and_leaves_the_guess) {
  int calls = 0;
  Given problem{1, [&](auto x, auto f) {
                  if (++calls == 3) throw std::runtime_error("no such ship");
                  f[0] = x[0] * x[0] - 2;
                }};
  std::vector<double> x{5};
  EXPECT_THROW((void)solve(problem, x), std::runtime_error);
  EXPECT_EQ(x[0], 5);
}

TEST_P(AnySolver, steps_back_from_where_the_equations_are_not_finite) {
  Given problem{1, [](auto x, auto f) { f[0] = x[0] > 0 ? std::log(x[0]) : std::numeric_limits<double>::quiet_NaN(); }};
  std::vector<double> x{3};  // Newton's first step leads to 3 - 3 log 3 < 0
  const SolverReport report = solve(problem, x);
  EXPECT_TRUE(report.converged) << report.reason;
  EXPECT_NEAR(x[0], 1, 1e-9);
}

TEST_P(AnySolver, reports_equations_that_are_nowhere_finite) {
  Given problem{1, [](auto, auto f) { f[0] = std::numeric_limits<double>::quiet_NaN(); }};
  std::vector<double> x{1};
  const SolverReport report = solve(problem, x);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.residual, std::numeric_limits<double>::infinity());
}

TEST_P(AnySolver, refuses_bad_guesses_and_options) {
  Given problem = rosenbrock();
  std::vector<double> short_one{1}, not_finite{1, std::numeric_limits<double>::quiet_NaN()}, good{1, 2};
  EXPECT_THROW((void)solve(problem, short_one), std::invalid_argument);
  EXPECT_THROW((void)solve(problem, not_finite), std::invalid_argument);
  EXPECT_THROW((void)solve(problem, good, {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW((void)solve(problem, good, {.max_iterations = 0}), std::invalid_argument);
}

TEST_P(AnySolver, has_nothing_to_do_for_no_equations) {
  Given problem{0, [](auto, auto) {}};
  std::vector<double> x;
  EXPECT_TRUE(solve(problem, x).converged);
}

TEST(Solvers, can_be_registered_under_a_name_of_ones_own) {
  struct Bisection final : Solver {
    Ending search(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) override {
      double low = 0, high = 2, f = 0;
      int count = 0;
      for (; count < 60; ++count) {
        x[0] = (low + high) / 2;
        problem.evaluate(x, {&f, 1});
        if (std::abs(f) <= options.tolerance) break;
        (f > 0 ? high : low) = x[0];
      }
      return {count, "converged"};
    }
  };
  register_solver("bisection", [] { return std::make_unique<Bisection>(); });
  Given problem{1, [](auto x, auto f) { f[0] = x[0] * x[0] - 2; }};
  std::vector<double> x{0};
  EXPECT_TRUE(make_solver("bisection")->solve(problem, x).converged);
  EXPECT_NEAR(x[0], std::numbers::sqrt2, 1e-9);
  Given rootless{1, [](auto, auto f) { f[0] = 1; }};
  EXPECT_FALSE(make_solver("bisection")->solve(rootless, x).converged) << "what a solver claims is checked";
}

TEST(Solvers, are_refused_by_name_with_the_names_that_there_are) {
  try {
    (void)make_solver("nwton");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("\"newton\""), std::string::npos);
  }
  const auto factory = [] { return make_solver("newton"); };
  EXPECT_THROW(register_solver("", factory), std::invalid_argument);
  EXPECT_THROW(register_solver("direct", factory), std::invalid_argument);
  EXPECT_THROW(register_solver(std::string(40, 'x'), factory), std::invalid_argument);
  EXPECT_THROW(register_solver("none", nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace iota
