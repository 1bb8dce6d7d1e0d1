// SPDX-License-Identifier: Apache-2.0
// The balance of single steps against their closed forms.
#include "solver/energy_balance.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

namespace iota::solver {
namespace {

constexpr double mass = 2;

/// A ball that is thrown up.
struct Throw {
  Problem problem;
  Newton newton;
  EnergyBalance balance;

  Throw() {
    problem.gravity = {0, -g, 0};
    add_point(problem, {1, 2, 3}, mass, {0.5, 3, 0});
  }
  StepEnergy step(const Stage& stage) {
    newton.compile(problem);
    std::fill(newton.displacement().begin(), newton.displacement().end(), Vec3{});
    EXPECT_TRUE(newton.solve(problem, stage).converged);
    balance.measure(problem, 0);
    return balance.of_solution(problem, newton, stage, {}, std::vector<double>(problem.multiplier_count()));
  }
};

TEST(EnergyBalance, of_a_throw_misses_nothing_by_the_mid_point_rule) {
  Throw ball;
  const StepEnergy energy = ball.step(Stage::mid_point(h, 0, 1));
  EXPECT_NEAR(energy.missing(), 0, 1e-12);
  EXPECT_NEAR(energy.kinetic, 0.5 * mass * (0.25 + (3 - g * h) * (3 - g * h)), 1e-12);
}

/// Backward Euler falls by h v1: the energy changes by -m (g h)^2 / 2.
TEST(EnergyBalance, of_a_throw_misses_the_loss_of_the_end_point_rule) {
  Throw ball;
  const StepEnergy energy = ball.step(Stage::end_point(h, 0, 1));
  EXPECT_NEAR(energy.missing(), 0.5 * mass * g * h * g * h, 1e-12);
  AdvanceReport report;
  ball.balance.take(energy, report);
  ball.balance.close(ball.problem, 1, h, report);
  EXPECT_NEAR(report.lost, 0.5 * mass * g * h * g * h, 1e-12);
  EXPECT_EQ(report.made, 0);
  EXPECT_EQ(ball.balance.missing, 0) << "it is told";
}

TEST(EnergyBalance, counts_the_work_of_an_explicit_force) {
  Throw ball;
  ball.problem.force[0] = {5, 0, 0};
  const StepEnergy energy = ball.step(Stage::mid_point(h, 0, 1));
  const double way = 0.5 * h + 0.5 * (5 / mass) * h * h;
  EXPECT_NEAR(energy.external_work, 5 * way, 1e-12);
  EXPECT_NEAR(energy.gained(), 0, 1e-12);
}

/// A rod that is too long by a gap pulls its point back. It had stored tension * gap / 2.
TEST(EnergyBalance, lets_rows_return_their_stored_energy_and_no_more) {
  constexpr double gap = 1e-6;
  Problem problem;
  const std::uint32_t fixed = add_point(problem, {}, mass), end = add_point(problem, {1 + gap, 0, 0}, mass);
  nail(problem, fixed);
  add_rod(problem, fixed, end, 1);
  Newton newton;
  newton.compile(problem);
  Stage stage = Stage::end_point(h, 0, 1);
  stage.tolerance = 1e-14;  // what is left of the gap stores nothing
  ASSERT_TRUE(newton.solve(problem, stage).converged);
  EnergyBalance balance;
  balance.measure(problem, 0);
  const auto energy_after_tension = [&](double tension) {
    const std::vector<double> multipliers_before(problem.multiplier_count(), tension);
    return balance.of_solution(problem, newton, stage, {}, multipliers_before);
  };
  const StepEnergy of_slack_rod = energy_after_tension(0);
  EXPECT_NEAR(of_slack_rod.made(), 0.5 * mass * (gap / h) * (gap / h), 1e-6 * mass * (gap / h) * (gap / h));
  const double allowed = gap * gap / (2 * stage.row_compliance() * 2 / mass);
  EXPECT_NEAR(of_slack_rod.overdrawn, allowed, 1e-5 * allowed) << "it had stored nothing";
  for (const double tension : {1.0, -1.0, 1e3, 1e6}) {
    const double stored = std::abs(tension) * gap / 2;
    EXPECT_NEAR(of_slack_rod.overdrawn - energy_after_tension(tension).overdrawn, stored, 1e-4 * stored);
  }
  EXPECT_EQ(energy_after_tension(1e30).overdrawn, 0);
  constexpr double share = 0.05;  // of the motion
  for (const double tension : {0.0, 1.0, 1e30}) {
    const StepEnergy energy = energy_after_tension(tension);
    EXPECT_NEAR(energy.recoil, allowed - share * energy.motion(), 1e-5 * allowed) << "stored or not";
  }
}

TEST(EnergyBalance, reports_as_made_only_energy_beyond_the_tolerance) {
  Throw ball;
  AdvanceReport report;
  ball.balance.missing = -1, ball.balance.slack = 2;
  ball.balance.close(ball.problem, 1, h, report);
  EXPECT_EQ(report.made, 0);
  EXPECT_EQ(report.lost, -1) << "its sign varies from step to step";
  ball.balance.missing = -3, ball.balance.slack = 2;
  ball.balance.close(ball.problem, 1, h, report);
  EXPECT_EQ(report.made, 3);
}

}  // namespace
}  // namespace iota::solver
