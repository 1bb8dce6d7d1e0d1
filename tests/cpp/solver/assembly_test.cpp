// SPDX-License-Identifier: Apache-2.0
// Residual and matrix of a step against each other and against small problems with known answers.
#include "solver/assembly.h"

#include "solver/active_set.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

namespace iota::solver {
namespace {

/// Rods, a nail, a tie, a joint's row and a spring, away from any solution.
struct Mixture {
  Problem problem = zigzag(4);
  std::vector<Vec3> u;

  Mixture() {
    std::mt19937 random(8);
    const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    add_spring(problem, 1, 4, 20, 0.3);
    const std::uint32_t tied = add_point(problem, {1, -1, 0}, 0.3);
    AffineConstraint tie;
    tie.nodes = {tied, 2, 3}, tie.weights = {1, -0.25, -0.75}, tie.count = 3;
    add(problem, tie);
    problem.mass_couplings.push_back({1, 3, 0.05});
    BilinearConstraint square;
    square.add(0, 0, -1), square.add(0, 1, 1), square.add(1, 2, -1), square.add(1, 3, 1);
    add(problem, square);
    for (std::size_t i = 0; i < problem.size(); ++i) {
      problem.velocity[i] = {number(), number(), number()};
      u.push_back(0.003 * Vec3{number(), number(), number()});
    }
    problem.for_each_constraint_pool([&](auto& pool) {
      pool.multipliers.resize(pool.items.size() * std::decay_t<decltype(pool.items[0])>::rows);
      for (double& lambda : pool.multipliers) lambda = 3 * number();
    });
  }
  /// The last point, on a line through two others, slips or sticks: to be called before it is compiled, and after.
  void add_friction() {
    FrictionLineConstraint line;
    line.friction = 0.4;
    line.add(0, 2, -1), line.add(1, 3, 2), line.add(1, 2, -2), line.first_side = 2;
    line.add(0, 4, 1);
    line.set_constant(2, {0, 1, 0}), line.set_constant(3, {0, 0, 1});
    add(problem, line);
  }
  void set_friction(const Stage& stage, bool slips) {
    auto& pool = problem.pool_of<FrictionLineConstraint>();
    double* const lambda = pool.multiplier(0);
    lambda[0] = 3, lambda[1] = -2, lambda[2] = (slips ? -0.4 : -0.2) * std::hypot(lambda[0], lambda[1]);
    ActiveSet().begin(problem, stage, problem.position.data());
    EXPECT_EQ(pool.is_equation(0, 2), !slips);
  }
  std::vector<Vec3> positions(const Stage& stage) const {
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < problem.size(); ++i)
      x.push_back(problem.position[i] + stage.h * problem.velocity[i] + u[i]);
    return x;
  }
};

std::vector<double> residuals(Assembly& assembly, const Mixture& m, const Stage& stage) {
  (void)assembly.residual(m.problem, stage, m.positions(stage).data(), m.u.data());
  return {assembly.residuals().begin(), assembly.residuals().end()};
}

/// The matrix K and the residual r give the step s = K^-1 r. Along it the residual has to fall at the rate r: that is
/// what K being the derivative means, checked without ever seeing K.
void expect_the_step_to_remove_the_residual(const Stage& stage, std::optional<bool> slips = {}) {
  Mixture m;
  Assembly assembly;
  if (slips) m.add_friction();
  assembly.compile(m.problem);
  if (slips) m.set_friction(stage, *slips);
  const std::vector<double> before = residuals(assembly, m, stage);
  (void)assembly.factor_and_solve(m.problem, stage, m.positions(stage).data(), Hessian::exact);
  const std::vector<double> step(assembly.step().begin(), assembly.step().end());

  const auto moved_by = [&](double part) {
    Mixture moved = m;
    for (std::size_t i = 0; i < moved.u.size(); ++i) {
      const double* const s = step.data() + assembly.unknown_of(static_cast<std::uint32_t>(i));
      moved.u[i] -= part * Vec3{s[0], s[1], s[2]};
    }
    moved.problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
      for (std::size_t k = 0; k < pool.items.size(); ++k)
        for (int r = 0; r < C::rows; ++r) pool.multiplier(k)[r] -= part * step[pool.slots[k].unknown + r];
    });
    return residuals(assembly, moved, stage);
  };
  const double part = slips ? 1e-7 : 1e-5;  // the reaction may change by much more than its size
  const std::vector<double> after = moved_by(part), opposite = moved_by(-part);
  double largest = 0;
  for (const double r : before) largest = std::max(largest, std::abs(r));
  ASSERT_GT(largest, 0.1);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_NEAR((opposite[i] - after[i]) / (2 * part), before[i], 1e-6 * largest) << "equation " << i;
}

TEST(Assembly, matrix_is_the_derivative_of_the_residual_at_the_end_point) {
  expect_the_step_to_remove_the_residual(Stage::end_point(0.01, 0, 1));
}
TEST(Assembly, matrix_is_the_derivative_of_the_residual_at_the_mid_point) {
  expect_the_step_to_remove_the_residual(Stage::mid_point(0.01, 0, 1));
}
TEST(Assembly, matrix_is_the_derivative_in_general_storage_at_the_end_point) {
  Stage stage = Stage::end_point(0.01, 0, 1);
  stage.storage = Storage::general;
  expect_the_step_to_remove_the_residual(stage);
}
TEST(Assembly, matrix_of_a_cone_is_the_derivative_whether_it_sticks_or_slips) {
  for (const bool slips : {false, true}) {
    expect_the_step_to_remove_the_residual(Stage::end_point(0.01, 0, 1), slips);
    expect_the_step_to_remove_the_residual(Stage::mid_point(0.01, 0, 1), slips);
  }
}

TEST(Assembly, both_storages_of_a_symmetric_matrix_give_the_same_step_and_the_same_signs) {
  for (const bool is_projection : {false, true})
    for (const double sign : {1, -1}) {  // tension, and compression that makes wrong pivots
      std::vector<double> steps[2];
      bool good[2];
      for (const Storage storage : {Storage::symmetric, Storage::general}) {
        Mixture m;
        auto& rods = m.problem.pool_of<DistanceConstraint>();
        for (double& tension : rods.multipliers) tension = sign * (is_projection ? 10 : 1e5);
        Assembly assembly;
        assembly.compile(m.problem);
        Stage stage = is_projection ? Stage::projection() : Stage::end_point(0.01, 0, 1);
        stage.storage = storage;
        (void)residuals(assembly, m, stage);
        const auto at = static_cast<std::size_t>(storage);
        good[at] = assembly.factor_and_solve(m.problem, stage, m.positions(stage).data(), Hessian::exact);
        steps[at].assign(assembly.step().begin(), assembly.step().end());
      }
      EXPECT_EQ(good[0], sign > 0);
      EXPECT_EQ(good[1], sign > 0);
      double largest = 0;
      for (const double s : steps[0]) largest = std::max(largest, std::abs(s));
      for (std::size_t i = 0; i < steps[0].size(); ++i) EXPECT_NEAR(steps[0][i], steps[1][i], 1e-9 * largest);
    }
}

TEST(Assembly, counts_three_unknowns_for_each_point_and_one_for_each_row) {
  Problem problem = zigzag(7);
  Assembly assembly;
  assembly.compile(problem);
  EXPECT_EQ(assembly.unknown_count(), 8u * 3 + 3 + 7);
  EXPECT_DOUBLE_EQ(assembly.reference_length(), 0.5) << "of the rods, by which the nail is measured too";
  std::vector<bool> taken(assembly.unknown_count());
  const auto take = [&](std::uint32_t first, int count) {
    for (int i = 0; i < count; ++i) {
      ASSERT_LT(first + i, taken.size());
      EXPECT_FALSE(taken[first + i]) << "two unknowns in one place";
      taken[first + i] = true;
    }
  };
  for (std::uint32_t i = 0; i < 8; ++i) take(assembly.unknown_of(i), 3);
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (const auto& slots : pool.slots) take(slots.unknown, C::rows);
  });
}

TEST(Assembly, residual_of_free_flight_is_the_weight) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  add_point(problem, {1, 2, 3}, 2, {4, 5, 6});
  Assembly assembly;
  assembly.compile(problem);
  const Stage stage = Stage::end_point(0.01, 0, 1);
  const Vec3 none_yet{}, x = problem.position[0] + 0.01 * problem.velocity[0];
  (void)assembly.residual(problem, stage, &x, &none_yet);
  const double* const r = assembly.residuals().data() + assembly.unknown_of(0);
  EXPECT_EQ(r[0], 0);
  EXPECT_DOUBLE_EQ(std::abs(r[1]), 2 * 9.81);
  EXPECT_EQ(r[2], 0);
}

TEST(Assembly, violation_is_relative_to_the_length_of_the_row) {
  Problem problem;
  const auto a = add_point(problem, {}), b = add_point(problem, {4.1, 0, 0});
  add_rod(problem, a, b, 4);
  Assembly assembly;
  assembly.compile(problem);
  const std::vector<Vec3> u(2), x = problem.position;
  const Residual residual = assembly.residual(problem, Stage::projection(), x.data(), u.data());
  EXPECT_NEAR(residual.violation, (4.1 * 4.1 - 16) / (2 * 4) / 4, 1e-12);
}

}  // namespace
}  // namespace iota::solver
