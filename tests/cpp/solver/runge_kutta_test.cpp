// SPDX-License-Identifier: Apache-2.0
#include "solver/runge_kutta.h"
#include "solver/integrator.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace iota::solver {
namespace {

/// A mass on a rod of 1 m, released level.
Problem pendulum() {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  (void)add_point(problem, {}), (void)add_point(problem, {1, 0, 0});
  nail(problem, 0);
  (void)add_rod(problem, 0, 1, 1);
  return problem;
}

/// Its place after a time, by that many steps.
Vec3 swing(double seconds, int steps) {
  Problem problem = pendulum();
  Newton newton;
  newton.compile(problem);
  RungeKutta rule;
  rule.begin(newton, problem);
  for (int i = 0; i < steps; ++i) {
    EXPECT_TRUE(rule.step(newton, problem, seconds / steps));
    rule.end(newton, problem);
    rule.accept(problem);
  }
  return problem.position[1];
}

TEST(RungeKutta, is_of_fifth_order) {
  const Vec3 truth = swing(1, 2000);
  const double coarse = norm(swing(1, 20) - truth), fine = norm(swing(1, 40) - truth);
  EXPECT_GT(fine, 1e-10) << "above round-off";
  EXPECT_NEAR(std::log2(coarse / fine), 5, 0.5);
}

TEST(RungeKutta, estimates_more_than_the_error_of_a_step) {
  Problem problem = pendulum();
  Newton newton;
  newton.compile(problem);
  RungeKutta rule;
  rule.begin(newton, problem);
  const double h = 0.1;
  ASSERT_TRUE(rule.step(newton, problem, h));
  rule.end(newton, problem);
  const double error = norm(problem.position[1] - swing(h, 100)), estimate = rule.estimate_error(h).position;
  EXPECT_LT(error, estimate);
  EXPECT_LT(estimate, 1e-5);
}

TEST(RungeKutta, ends_on_the_constraints_and_can_go_back) {
  Problem problem = pendulum();
  const Vec3 start = problem.position[1];
  Newton newton;
  newton.compile(problem);
  RungeKutta rule;
  rule.begin(newton, problem);
  ASSERT_TRUE(rule.step(newton, problem, 0.2));
  const Vec3 x = problem.position[1], v = problem.velocity[1];
  EXPECT_NEAR(norm(x), 1, 1e-13);
  EXPECT_NEAR(dot(x, v), 0, 1e-13);
  EXPECT_GT(norm(x - start), 0.1);
  rule.reject(problem);
  EXPECT_EQ(problem.position[1], start);
  EXPECT_EQ(problem.velocity[1], Vec3{});
}

TEST(RungeKutta, finds_the_acceleration_and_the_tension_of_a_circle) {
  Problem problem = pendulum();
  problem.gravity = {};
  problem.velocity[1] = {0, 3, 0};
  Newton newton;
  newton.compile(problem);
  std::vector<Vec3> accelerations(2);
  newton.find_accelerations(problem, accelerations);
  EXPECT_NEAR(norm(accelerations[1] - Vec3{-9, 0, 0}), 0, 1e-10) << "v^2 / r towards the center";
  EXPECT_NEAR(*pool<DistanceConstraint>(problem).multiplier(0), 9, 1e-10) << "m v^2 / r, a tension";
}

/// Energy, and angular momentum about the origin.
std::pair<double, Vec3> invariants(const Problem& problem) {
  Vec3 spin;
  for (std::size_t i = 0; i < problem.size(); ++i)
    spin += problem.mass[i] * cross(problem.position[i], problem.velocity[i]);
  return {problem.kinetic_energy() + problem.potential_energy(problem.position.data()), spin};
}

TEST(Accurate, keeps_energy_and_angular_momentum_of_a_free_body_to_round_off) {
  Problem problem;
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}, {0, 0, 0.3}};
  const Vec3 spin{0.1, 3, 0.2};
  for (const Vec3& x : corners) (void)add_point(problem, x, 1 + x.x, cross(spin, x));
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b) (void)add_rod(problem, a, b, norm(corners[b] - corners[a]));
  Integrator integrator;
  integrator.compile(problem);
  const auto [energy, momentum] = invariants(problem);
  double error = 0;
  for (int i = 0; i < 600; ++i) {
    const AdvanceReport report = integrator.advance(problem, 1.0 / 60, IntegratorSettings::accurate());
    error = std::max(error, report.error);
    ASSERT_TRUE(report.converged);
  }
  const auto [energy_after, momentum_after] = invariants(problem);
  EXPECT_NEAR(energy_after, energy, 1e-11 * energy);
  EXPECT_LT(norm(momentum_after - momentum), 1e-11 * norm(momentum));
  EXPECT_GT(error, 0);
  EXPECT_LE(error, 1e-4);
}

TEST(Accurate, falls_back_on_estimated_mid_point_steps_where_a_row_closes) {
  Problem problem = pendulum();  // that meets a stop at the bottom: x >= 0
  const std::size_t stop = add(problem, along(1, {1, 0, 0}, 0));
  pool<BilinearConstraint>(problem).law(stop)->upper = 0;
  Integrator integrator;
  integrator.compile(problem);
  double lost = 0, lowest = 1;
  for (int i = 0; i < 120; ++i) {
    const AdvanceReport report = integrator.advance(problem, 1.0 / 60, IntegratorSettings::accurate());
    ASSERT_TRUE(report.converged);
    lost += report.dissipated;
    lowest = std::min(lowest, problem.position[1].x);
  }
  EXPECT_GT(lowest, -1e-9);
  EXPECT_NEAR(lost, 9.81, 0.05) << "the impact takes the energy of the fall";
  EXPECT_NEAR(problem.position[1].y, -1, 1e-3);
}

TEST(Accurate, steps_over_stiff_springs_by_the_mid_point_rule) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  (void)add_point(problem, {}), (void)add_point(problem, {0, -1, 0}, 1e-3);
  nail(problem, 0);
  add_spring(problem, 0, 1, 1e8, 1);  // 50 000 oscillations a second
  Integrator integrator;
  integrator.compile(problem);
  for (int i = 0; i < 5; ++i) (void)integrator.advance(problem, 1.0 / 60, IntegratorSettings::accurate());
  EXPECT_NEAR(problem.position[1].y, -1, 1e-6);
}

}  // namespace
}  // namespace iota::solver
