// SPDX-License-Identifier: Apache-2.0
// Beads that stick to a line and slip along it: against closed forms, against the conditions of friction in every step,
// and against another solver of the same equations.
#include "solver/constraints/friction_line.h"

#include "solver/integrator.h"
#include "tests/cpp/allocations.h"
#include "tests/cpp/solver/constraints/cone_derivatives.h"
#include "tests/cpp/solver/small_problem.h"

#include <iota/solver.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

namespace iota::solver {
namespace {

/// A line in the world through a point, along a direction.
FrictionLineConstraint line(const Vec3& through, const Vec3& along, double friction) {
  FrictionLineConstraint c;
  const Vec3 t = (1 / norm(along)) * along, n = any_perpendicular(t);
  c.set_constant(0, -1.0 * through);
  c.set_constant(1, t), c.set_constant(2, n), c.set_constant(3, cross(t, n));
  c.friction = friction;
  return c;
}

class Beads : public testing::TestWithParam<Scheme> {
 protected:
  Problem problem;
  Integrator integrator;
  AdvanceReport total;

  bool is_mid_point() const { return GetParam() == Scheme::mid_point; }
  void SetUp() override { problem.gravity = {0, -g, 0}; }
  const FrictionLineConstraint& constraint() { return pool<FrictionLineConstraint>(problem).items[0]; }
  const double* multipliers() { return pool<FrictionLineConstraint>(problem).multiplier(0); }
  double place() { return constraint().place(problem.position.data(), 1).x; }
  /// A bead in the middle of a line.
  std::uint32_t make_bead(const Vec3& along, double friction, double mass = 2, const Vec3& velocity = {}) {
    const std::uint32_t bead = add_point(problem, {0.3, 0.2, -0.1}, mass, velocity);
    FrictionLineConstraint c = line(problem.position[bead], along, friction);
    c.add(0, bead, 1);
    add(problem, c);
    return bead;
  }
  void step(double h) {
    const AdvanceReport report = integrator.advance(problem, h, IntegratorSettings{.scheme = GetParam()});
    ASSERT_TRUE(report.converged);
    EXPECT_EQ(report.fallbacks, 0);
    total.dissipated += report.dissipated, total.lost += report.lost, total.made += report.made;
    total.iterations += report.iterations, total.substeps += report.substeps;
  }
  double energy() const { return problem.kinetic_energy() + problem.potential_energy(problem.position.data()); }
};

INSTANTIATE_TEST_SUITE_P(Both, Beads, testing::Values(Scheme::end_point, Scheme::mid_point),
                         [](const auto& info) { return info.param == Scheme::mid_point ? "mid_point" : "end_point"; });

TEST_P(Beads, stick_to_a_slope_or_slide_as_the_coefficient_says) {
  constexpr double angle = 0.5, mass = 2;
  const int steps = 200;
  const Vec3 down{std::cos(angle) * std::cos(0.3), -std::sin(angle), std::cos(angle) * std::sin(0.3)};
  for (const double friction : {0.0, 0.3, 0.999 * std::tan(angle), 1.001 * std::tan(angle), 2.0}) {
    SCOPED_TRACE(friction);
    problem = Problem{}, total = {}, SetUp();
    make_bead(down, friction, mass);
    integrator.compile(problem);
    const double before = energy(), start = place();
    for (int i = 0; i < steps; ++i) step(h);
    const double way = place() - start, reaction = mass * g * std::cos(angle);
    EXPECT_NEAR(std::hypot(multipliers()[0], multipliers()[1]), reaction, 1e-7);
    if (friction > std::tan(angle)) {
      EXPECT_NEAR(way, 0, 1e-10) << "it does not creep";
      EXPECT_NEAR(multipliers()[2], mass * g * std::sin(angle), 1e-6);
      EXPECT_NEAR(total.dissipated, 0, 1e-9);
    } else {
      const double a = g * (std::sin(angle) - friction * std::cos(angle));
      EXPECT_NEAR(way, a * h * h * steps * (is_mid_point() ? steps : steps + 1) / 2, 1e-9);
      EXPECT_NEAR(multipliers()[2], friction * reaction, 1e-7);
      EXPECT_NEAR(total.dissipated, friction * reaction * way, 1e-7) << "mu N s";
    }
    EXPECT_NEAR(before - energy(), total.dissipated + total.lost - total.made, 1e-9);
    if (is_mid_point()) {
      EXPECT_NEAR(total.lost - total.made, 0, 1e-9);
    }
    EXPECT_LE(total.iterations, 4 * steps);
  }
}

TEST_P(Beads, that_are_thrown_uphill_stop_and_stay_or_come_back) {
  constexpr double angle = 0.5, speed = 3;
  const Vec3 down{std::cos(angle), -std::sin(angle), 0};
  for (const double friction : {0.2, 0.9}) {
    problem = Problem{}, total = {}, SetUp();
    const auto bead = make_bead(down, friction, 2, -speed * down);
    integrator.compile(problem);
    const double start = place();
    double highest = 0;
    for (int i = 0; i < 400; ++i) step(0.005), highest = std::max(highest, start - place());
    EXPECT_NEAR(highest, speed * speed / (2 * g * (std::sin(angle) + friction * std::cos(angle))), 2e-2);
    EXPECT_EQ(norm(problem.velocity[bead]) > 1, friction < std::tan(angle));
    if (friction > std::tan(angle)) {
      EXPECT_NEAR(norm(problem.velocity[bead]), 0, 1e-9);
    }
  }
}

TEST_P(Beads, on_a_spring_come_to_rest_where_friction_holds_it) {
  constexpr double friction = 0.1, mass = 2, stiffness = 80;
  const auto bead = make_bead({1, 0, 0}, friction, mass);
  const auto anchor = add_point(problem, problem.position[bead] - Vec3{1.4, 0, 0});
  nail(problem, anchor);
  add_spring(problem, anchor, bead, stiffness, 1);
  integrator.compile(problem);
  const double before = energy();
  int turns = 0;
  double last = 0;
  for (int i = 0; i < 1500; ++i) {
    step(0.004);
    const double v = problem.velocity[bead].x;
    turns += v * last < 0, last = v != 0 ? v : last;
  }
  EXPECT_GE(turns, 3) << "it oscillates before";
  EXPECT_NEAR(norm(problem.velocity[bead]), 0, 1e-9);
  const double stretch = norm(problem.position[bead] - problem.position[anchor]) - 1;
  EXPECT_LE(std::abs(stretch) * stiffness, friction * mass * g * (1 + 1e-6));
  EXPECT_NEAR(before - energy(), total.dissipated + total.lost - total.made, 1e-8);
  if (is_mid_point()) {
    EXPECT_LT(std::abs(total.lost - total.made), 1e-4 * total.dissipated);
  }
  const Vec3 there = problem.position[bead];
  for (int i = 0; i < 1000; ++i) step(0.004);
  EXPECT_LT(norm(problem.position[bead] - there), 1e-10);
}

/// A rod that hangs from a bead: the reaction depends on the friction, and changes its direction and size.
struct Pendulum {
  std::uint32_t bead, weight;
};
Pendulum add_pendulum(Problem& problem, std::uint32_t bead, double mass) {
  const auto weight = add_point(problem, problem.position[bead] + Vec3{0.3, -0.2, 0.6}, mass);
  add_rod(problem, bead, weight, 0.7);
  return {bead, weight};
}

TEST_P(Beads, keep_to_the_conditions_of_friction_in_every_step) {
  std::mt19937 random(3);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int sticks = 0, slips[2] = {};
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    problem = Problem{}, total = {}, SetUp();
    const Vec3 along{1, number(-0.3, 0.3), number(-1, 1)};
    const double friction = number(0.05, 0.5);
    const auto bead = make_bead(along, friction, std::pow(10, number(-1, 0.5)));
    const Pendulum pendulum = add_pendulum(problem, bead, std::pow(10, number(-1, 0.5)));
    problem.velocity[pendulum.weight] =
        cross({0, number(-2, 2), 0}, problem.position[pendulum.weight] - problem.position[bead]);
    integrator.compile(problem);
    const double start = energy();
    for (int i = 0; i < 150; ++i) {
      const double before = place();
      const int substeps = total.substeps;
      step(0.005);
      if (total.substeps != substeps + 1) continue;  // which have states of their own
      const double edge = friction * std::hypot(multipliers()[0], multipliers()[1]), moved = place() - before;
      const double force = multipliers()[2];
      ASSERT_LE(std::abs(force), edge + 1e-4 * (edge + 1)) << "step " << i;
      if (std::abs(moved) > 1e-8) {
        ASSERT_NEAR(force, moved > 0 ? edge : -edge, 1e-4 * (edge + 1)) << "step " << i;
        ++slips[moved > 0];
      } else {
        ++sticks;
      }
    }
    EXPECT_NEAR(start - energy(), total.dissipated + total.lost - total.made, 1e-7 * (1 + std::abs(start)));
    EXPECT_LT(total.made, 1e-6);
  }
  EXPECT_GT(sticks, 50);
  EXPECT_GT(slips[0], 50);
  EXPECT_GT(slips[1], 50);
}

TEST_P(Beads, move_in_another_solver_as_in_this_one) {
  bool has_slipped = false, has_stuck = false;
  for (const double friction : {0.1, 0.6, 2.0}) {
    problem = Problem{}, total = {}, SetUp();
    const auto bead = make_bead({1, -0.1, 0.5}, friction);
    const Pendulum pendulum = add_pendulum(problem, bead, 1);
    Problem twin = problem;
    Integrator other;
    const std::unique_ptr<Solver> dense = make_solver("newton");
    other.set_external(dense.get());
    integrator.compile(problem), other.compile(twin);
    for (int i = 0; i < 120; ++i) {
      const double before = place();
      step(0.005);
      const AdvanceReport report = other.advance(twin, 0.005, IntegratorSettings{.scheme = GetParam()});
      ASSERT_EQ(report.handed_back, 0) << "step " << i;
      (std::abs(place() - before) > 1e-7 ? has_slipped : has_stuck) = true;
      for (const std::uint32_t node : {bead, pendulum.weight})
        ASSERT_LT(norm(problem.position[node] - twin.position[node]), 5e-7) << "step " << i;
    }
  }
  EXPECT_TRUE(has_slipped && has_stuck);
}

/// A line along a free body, a tetrahedron of rods.
TEST_P(Beads, on_a_line_of_a_free_body_share_momentum_with_it_and_come_to_rest_in_it) {
  problem.gravity = {};
  const Vec3 corners[4] = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3& corner : corners) (void)add_point(problem, corner, 1);
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b) add_rod(problem, a, b, norm(corners[a] - corners[b]));
  const Vec3 spin{0, 0, 2}, center{0.5, 0.25, 0.25}, start_of_bead{0.5, 1.45, 0.25};
  for (std::uint32_t i = 0; i < 4; ++i) problem.velocity[i] = cross(spin, corners[i] - center);
  const auto bead = add_point(problem, start_of_bead, 0.5, cross(spin, start_of_bead - center) + Vec3{0.8, 0, 0});
  FrictionLineConstraint c;
  c.friction = 0.6;
  const double weights[4] = {-0.7, 0, 1.45, 0.25};  // of (0, 1.45, 0.25), far from the axis: the reaction lasts
  for (std::uint32_t i = 0; i < 4; ++i) c.add(0, i, -weights[i]);
  c.first_side = 4;
  c.add(0, bead, 1);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double length = norm(corners[k + 1]);
    c.add(1 + static_cast<int>(k), k + 1, 1 / length), c.add(1 + static_cast<int>(k), 0, -1 / length);
  }
  add(problem, c);
  integrator.compile(problem);
  integrator.project_velocities(problem);
  const auto momenta = [&] {
    Vec3 linear, angular;
    for (std::uint32_t i = 0; i < problem.size(); ++i) {
      linear += problem.mass[i] * problem.velocity[i];
      angular += problem.mass[i] * cross(problem.position[i], problem.velocity[i]);
    }
    return std::pair{linear, angular};
  };
  const auto [linear, angular] = momenta();
  const double before = energy(), start = place();
  for (int i = 0; i < 600; ++i) step(0.005);
  EXPECT_GT(std::abs(place() - start), 0.05);
  const double there = place();
  for (int i = 0; i < 100; ++i) step(0.005);
  EXPECT_NEAR(place(), there, 1e-8);
  EXPECT_LT(norm(momenta().first - linear), 1e-9);
  EXPECT_LT(norm(momenta().second - angular), is_mid_point() ? 1e-8 : 1e-6);
  EXPECT_NEAR(before - energy(), total.dissipated + total.lost - total.made, 1e-8);
  EXPECT_GT(total.dissipated, 0.01);
}

TEST_P(Beads, allocate_nothing_when_they_begin_to_slip) {
  const auto bead = make_bead({1, 0, 0}, 0.3);
  integrator.compile(problem);
  for (int i = 0; i < 5; ++i) step(h);
  const long before = allocations;
  problem.force[bead] = {8, 0, 0};
  for (int i = 0; i < 5; ++i) step(h);
  problem.force[bead] = {};
  for (int i = 0; i < 60; ++i) step(h);
  EXPECT_EQ(allocations, before);
  EXPECT_NEAR(norm(problem.velocity[bead]), 0, 1e-9);
  EXPECT_GT(total.dissipated, 0);
}

TEST(FrictionLine, has_equations_with_the_derivatives_that_finite_differences_say) {
  std::mt19937 random(5);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  const double natural[3] = {0.4, 0.5, 0.7};
  for (int round = 0; round < 50; ++round) {
    FrictionLineConstraint c;
    c.friction = 0.5 + 0.4 * number();
    using Mode = ConeState::Mode;
    for (const ConeState state :
         {ConeState{}, ConeState{Mode::slips, 1}, ConeState{Mode::slips, -1}, ConeState{Mode::slips, 0}}) {
      std::array<double, 6> at;
      for (double& value : at) value = number();
      expect_derivatives(c, state, at, natural);
    }
  }
}

}  // namespace
}  // namespace iota::solver
