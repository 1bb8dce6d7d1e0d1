// SPDX-License-Identifier: Apache-2.0
// Newton's method on problems whose solutions are known in closed form.
#include "solver/newton.h"

#include "tests/cpp/allocations.h"
#include "tests/cpp/solver/small_problem.h"

#include <iota/solver.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace iota::solver {
namespace {

NewtonReport solve(Newton& newton, Problem& problem, const Stage& stage) {
  newton.compile(problem);
  std::fill(newton.displacement().begin(), newton.displacement().end(), Vec3{});
  return newton.solve(problem, stage);
}

double distance_between(const Vec3& a, const Vec3& b) { return norm(a - b); }

TEST(Newton, solves_free_fall_in_one_iteration) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  add_point(problem, {0, 5, 0}, 2, {1, 0, 0});
  Newton newton;
  const NewtonReport end = solve(newton, problem, Stage::end_point(h, 0, 1));
  EXPECT_TRUE(end.converged);
  EXPECT_EQ(end.iterations, 1);
  EXPECT_LT(distance_between(newton.displacement()[0], {0, -9.81 * h * h, 0}), 1e-16);
  EXPECT_EQ(solve(newton, problem, Stage::mid_point(h, 0, 1)).iterations, 1);
  EXPECT_LT(distance_between(newton.displacement()[0], {0, -9.81 * h * h / 2, 0}), 1e-16) << "exact on a parabola";
}

TEST(Newton, finds_the_force_that_a_nail_has_to_bear) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  const auto p = add_point(problem, {1, 2, 3}, 4);
  nail(problem, p);
  Newton newton;
  EXPECT_TRUE(solve(newton, problem, Stage::end_point(h, 0, 1)).converged);
  const double* const force = pool<AffineConstraint>(problem).multiplier(0);
  EXPECT_NEAR(force[1], -4 * 9.81, 1e-9) << "minus the force on the point";
  EXPECT_LT(distance_between(newton.solution()[p], {1, 2, 3}), 1e-12);
}

/// Backward Euler leaves the pendulum where free flight meets its circle: M (x - x_free) / h^2 + lambda x / L = 0 makes x
/// parallel to x_free.
TEST(Newton, steps_a_pendulum_to_where_free_flight_points) {
  const double length = 2, mass = 3;
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  const auto hook = add_point(problem, {}), bob = add_point(problem, {2, 0, 0}, mass, {0, -1, 0.5});
  nail(problem, hook);
  const auto rod = add_rod(problem, hook, bob, length);
  Newton newton;
  const NewtonReport report = solve(newton, problem, Stage::end_point(h, 0, 1));
  ASSERT_TRUE(report.converged);
  const Vec3 free = problem.position[bob] + h * problem.velocity[bob] + h * h * problem.gravity;
  EXPECT_LT(distance_between(newton.solution()[bob], (length / norm(free)) * free), 1e-10);
  const double tension = mass * (norm(free) - length) / (h * h);
  EXPECT_NEAR(pool<DistanceConstraint>(problem).multiplier(rod)[0], tension, 1e-5);
}

TEST(Newton, projects_positions_by_the_least_movement_of_mass) {
  Problem problem;
  const auto light = add_point(problem, {}, 1), heavy = add_point(problem, {3, 4, 0}, 4);
  add_rod(problem, light, heavy, 4);
  Newton newton;
  ASSERT_TRUE(solve(newton, problem, Stage::projection()).converged);
  const Vec3 along{0.6, 0.8, 0};  // 5 m apart, one too many: the light one goes four fifths of it
  EXPECT_LT(distance_between(newton.solution()[light], 0.8 * along), 1e-9);
  EXPECT_LT(distance_between(newton.solution()[heavy], 4.8 * along), 1e-9);
}

TEST(Newton, converges_quadratically_near_a_solution) {
  Problem problem = zigzag(40);
  Newton newton;
  const NewtonReport report = solve(newton, problem, Stage::end_point(1.0 / 240, 0, 1));
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.iterations, 4);
  EXPECT_LE(report.residual, 1e-9);
  EXPECT_LT(report.violation, 1e-9);
}

TEST(Newton, leaves_the_problem_alone_and_stops_at_its_limit_of_iterations) {
  Problem problem = zigzag(10);
  problem.velocity.back() = {3, 40, -20};
  const std::vector<Vec3> x = problem.position, v = problem.velocity;
  Stage stage = Stage::end_point(0.05, 0, 1);
  stage.max_iterations = 1;
  Newton newton;
  const NewtonReport report = solve(newton, problem, stage);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_EQ(problem.position, x);
  EXPECT_EQ(problem.velocity, v);
}

TEST(Newton, says_that_a_conflict_is_not_solved_and_shares_it) {
  Problem problem;
  const auto a = add_point(problem, {}), b = add_point(problem, {1, 0, 0}), c = add_point(problem, {2, 0, 0});
  nail(problem, a), nail(problem, c);
  add_rod(problem, a, b, 0.9), add_rod(problem, b, c, 0.9);  // 0.2 m too short
  Newton newton;
  const NewtonReport report = solve(newton, problem, Stage::projection(1e-3));
  EXPECT_GT(report.violation, 1e-3);
  for (const Vec3& x : newton.solution()) EXPECT_TRUE(is_finite(x));
  EXPECT_NEAR(newton.solution()[b].x, 1, 1e-6) << "both rods are too short by as much";
}

TEST(Newton, projects_velocities_onto_the_motions_of_a_rod) {
  Problem problem;
  const auto hook = add_point(problem, {}), bob = add_point(problem, {3, 4, 0}, 2, {1, 2, 3});
  nail(problem, hook);
  add_rod(problem, hook, bob, 5);
  Newton newton;
  newton.compile(problem);
  newton.project_velocities(problem, 0);
  const Vec3 along{0.6, 0.8, 0}, before{1, 2, 3};
  EXPECT_LT(distance_between(problem.velocity[bob], before - dot(before, along) * along), 1e-12);
  EXPECT_LT(norm(problem.velocity[hook]), 1e-12);
}

TEST(Newton, projects_velocities_of_floating_bodies_without_changing_momentum) {
  Problem problem = zigzag(6);
  pool<AffineConstraint>(problem).items.clear();  // off its nail
  for (std::size_t i = 0; i < problem.size(); ++i)
    problem.velocity[i] = {std::sin(double(i)), std::cos(2.0 * double(i)), 0.3 * double(i)};
  const auto momenta = [&] {
    Vec3 linear, angular;
    for (std::size_t i = 0; i < problem.size(); ++i) {
      linear += problem.mass[i] * problem.velocity[i];
      angular += problem.mass[i] * cross(problem.position[i], problem.velocity[i]);
    }
    return std::pair{linear, angular};
  };
  const auto before = momenta();
  const double energy = problem.kinetic_energy();
  Newton newton;
  newton.compile(problem);
  newton.project_velocities(problem, 0);
  EXPECT_LT(norm(momenta().first - before.first), 1e-14);
  EXPECT_LT(norm(momenta().second - before.second), 1e-12);
  EXPECT_LT(problem.kinetic_energy(), energy);
  for (const DistanceConstraint& rod : pool<DistanceConstraint>(problem).items) {
    const auto [a, b] = rod.nodes;
    const Vec3 along = problem.position[b] - problem.position[a];
    EXPECT_NEAR(dot(along, problem.velocity[b] - problem.velocity[a]), 0, 1e-12);
  }
}

/// Asks for nothing and finds nothing.
struct Idle final : Solver {
  int asked = 0;
  Ending search(NonlinearProblem&, std::span<double>, const SolverOptions&) override { return ++asked, Ending{}; }
};

TEST(Newton, solves_equations_without_a_root_by_another_solver_and_all_projections_itself) {
  Problem problem = zigzag(5);
  Newton own, helped;
  const NewtonReport plain = solve(own, problem, Stage::end_point(h, 0, 1));
  ASSERT_TRUE(plain.converged);
  EXPECT_FALSE(plain.handed_back);
  Problem again = zigzag(5);
  Idle idle;
  helped.set_external(&idle);
  const NewtonReport report = solve(helped, again, Stage::end_point(h, 0, 1));
  EXPECT_TRUE(report.converged && report.handed_back);
  EXPECT_TRUE(std::equal(own.solution().begin(), own.solution().end(), helped.solution().begin()));
  EXPECT_EQ(idle.asked, 1);
  (void)solve(helped, again, Stage::projection());
  EXPECT_EQ(idle.asked, 1);
}

TEST(Newton, that_is_warm_allocates_nothing) {
  Problem problem = zigzag(30);
  Newton newton;
  (void)solve(newton, problem, Stage::end_point(h, 0, 1));
  const long before = allocations;
  std::fill(newton.displacement().begin(), newton.displacement().end(), Vec3{});
  EXPECT_TRUE(newton.solve(problem, Stage::end_point(h, 0, 1)).converged);
  newton.project_velocities(problem, h);
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace iota::solver
