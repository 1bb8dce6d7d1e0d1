// SPDX-License-Identifier: Apache-2.0
// Which bounded rows hold: against all combinations, tried one by one.
#include "solver/active_set.h"

#include "solver/newton.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace iota::solver {
namespace {

/// Beads of different masses on a line, in free flight, each of which may not pass its own stop, nor come nearer to the
/// next one than a gap: a quadratic program
///   min sum m_i (x_i - free_i)^2 / 2   with   x_i >= stop_i,   x_{i+1} - x_i >= gap_i.
struct Beads {
  std::vector<double> mass, free, stop, gap;
  std::size_t size() const { return mass.size(); }

  /// Coefficients and bound of the k-th row, a . x >= b.
  std::pair<std::vector<double>, double> row(std::size_t k) const {
    std::vector<double> a(size(), 0.0);
    if (k < size()) return a[k] = 1, std::pair{a, stop[k]};
    const std::size_t i = k - size();
    return a[i] = -1, a[i + 1] = 1, std::pair{a, gap[i]};
  }
  std::size_t row_count() const { return 2 * size() - 1; }
};

/// Solves a small dense system by elimination; empty where it is singular.
std::vector<double> solve_dense(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t pivot = i;
    for (std::size_t r = i; r < n; ++r)
      if (std::abs(a[r][i]) > std::abs(a[pivot][i])) pivot = r;
    if (std::abs(a[pivot][i]) < 1e-9) return {};
    std::swap(a[i], a[pivot]), std::swap(b[i], b[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const double factor = a[r][i] / a[i][i];
      for (std::size_t c = i; c < n; ++c) a[r][c] -= factor * a[i][c];
      b[r] -= factor * b[i];
    }
  }
  for (std::size_t i = 0; i < n; ++i) b[i] /= a[i][i];
  return b;
}

/// The solution by trying every set of rows: that one whose forces all push and which passes no stop.
std::vector<double> by_trying_all(const Beads& beads) {
  const std::size_t n = beads.size(), rows = beads.row_count();
  for (unsigned set = 0; set < 1u << rows; ++set) {
    std::vector<std::size_t> held;
    for (std::size_t k = 0; k < rows; ++k)
      if (set >> k & 1) held.push_back(k);
    if (held.size() > n) continue;
    const std::size_t size = n + held.size();
    std::vector<std::vector<double>> a(size, std::vector<double>(size, 0.0));
    std::vector<double> b(size);
    for (std::size_t i = 0; i < n; ++i) a[i][i] = beads.mass[i], b[i] = beads.mass[i] * beads.free[i];
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto [row, bound] = beads.row(held[k]);
      for (std::size_t i = 0; i < n; ++i) a[i][n + k] = -row[i], a[n + k][i] = row[i];
      b[n + k] = bound;
    }
    const std::vector<double> x = solve_dense(a, b);
    if (x.empty()) continue;
    bool good = true;
    for (std::size_t k = 0; k < held.size(); ++k) good = good && x[n + k] >= -1e-12;
    for (std::size_t k = 0; k < rows; ++k) {
      const auto [row, bound] = beads.row(k);
      double value = -bound;
      for (std::size_t i = 0; i < n; ++i) value += row[i] * x[i];
      good = good && value >= -1e-12;
    }
    if (good) return {x.begin(), x.begin() + static_cast<std::ptrdiff_t>(n)};
  }
  return {};
}

/// The same for the solver: one step of end points that starts with every row open.
Problem problem_of(const Beads& beads) {
  Problem problem;
  for (std::size_t i = 0; i < beads.size(); ++i) {
    const double start = 10 * double(i);
    const auto p = add_point(problem, {start, 0, 0}, beads.mass[i], {(beads.free[i] - start) / h, 0, 0});
    add(problem, along(p, {0, 1, 0}, 0)), add(problem, along(p, {0, 0, 1}, 0));
  }
  for (std::size_t k = 0; k < beads.row_count(); ++k) {
    BilinearConstraint row;
    const auto [a, bound] = beads.row(k);
    for (std::uint32_t i = 0; i < beads.size(); ++i)
      if (a[i] != 0) row.add(0, i, a[i]);
    row.set_constant(1, {1, 0, 0});
    row.product = bound;
    const std::size_t item = add(problem, row);
    pool<BilinearConstraint>(problem).law(item)->upper = 0;  // may push, not pull
  }
  return problem;
}

TEST(ActiveSet, finds_the_one_set_of_stops_that_holds) {
  std::mt19937 random(12);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int held = 0;
  for (int round = 0; round < 200; ++round) {
    Beads beads;
    for (int i = 0; i < 5; ++i) {
      beads.mass.push_back(std::pow(10, number(-1, 1)));
      beads.free.push_back(i + number(-1, 1));
      beads.stop.push_back(i + number(-2, 0.5));
      if (i > 0) beads.gap.push_back(number(0.2, 1.2));
    }
    const std::vector<double> expected = by_trying_all(beads);
    ASSERT_FALSE(expected.empty()) << "the slow twin has to find it";
    Problem problem = problem_of(beads);
    Newton newton;
    newton.compile(problem);
    std::fill(newton.displacement().begin(), newton.displacement().end(), Vec3{});
    const NewtonReport report = newton.solve(problem, Stage::end_point(h, 0, 1));
    ASSERT_TRUE(report.converged) << "round " << round;
    for (std::size_t i = 0; i < beads.size(); ++i) {
      EXPECT_NEAR(newton.solution()[i].x, expected[i], 1e-7) << "round " << round << " bead " << i;
      held += std::abs(expected[i] - beads.free[i]) > 1e-6;
    }
  }
  EXPECT_GT(held, 300) << "most beads are held by something, or nothing is tested";
}

/// One bead at rest, 0.5 m above a stop that may only push up.
struct OneStop {
  Problem problem;
  std::size_t stop;
  ActiveSet set;
  const Stage stage = Stage::end_point(h, 0, 1);

  OneStop() {
    const auto bead = add_point(problem, {0, 0.5, 0});
    stop = add(problem, along(bead, {0, 1, 0}, 0));
    pool<BilinearConstraint>(problem).law(stop)->upper = 0;
    Newton().compile(problem);
  }
  bool is_equation() { return pool<BilinearConstraint>(problem).is_equation(stop, 0); }
  double& multiplier() { return pool<BilinearConstraint>(problem).multiplier(stop)[0]; }
  void begin() { set.begin(problem, stage, problem.position.data()); }
  bool choose(double height) {
    const Vec3 x{0, height, 0};
    return set.choose(problem, stage, &x);
  }
};

TEST(ActiveSet, begins_on_the_sides_that_the_last_multipliers_tell) {
  OneStop open, pushing;
  open.multiplier() = 0, pushing.multiplier() = -5;
  open.begin(), pushing.begin();
  EXPECT_FALSE(open.is_equation()) << "a force of zero is its bound";
  EXPECT_TRUE(pushing.is_equation()) << "it pushes: the equation holds";
}

TEST(ActiveSet, frees_a_row_that_is_passed_and_drops_one_that_would_pull) {
  OneStop one;
  one.begin();
  EXPECT_FALSE(one.choose(0.1)) << "above the stop nothing is to be done";
  EXPECT_TRUE(one.choose(-0.1));
  EXPECT_TRUE(one.is_equation());
  EXPECT_EQ(ActiveSet::count_met(one.problem), 1);
  one.multiplier() = -5;
  EXPECT_FALSE(one.choose(0)) << "it rests on the stop";
  one.multiplier() = 5;
  EXPECT_TRUE(one.choose(0));
  EXPECT_FALSE(one.is_equation());
  EXPECT_EQ(one.multiplier(), 0) << "at its bound";
}

TEST(ActiveSet, takes_no_row_into_an_impact_that_is_open) {
  for (const double height : {0.0, 0.5}) {
    OneStop one;
    one.problem.position[0].y = height;
    ActiveSet::begin_impulses(one.problem);
    EXPECT_EQ(one.is_equation(), height == 0);
  }
}

}  // namespace
}  // namespace iota::solver
