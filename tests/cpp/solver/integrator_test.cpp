// SPDX-License-Identifier: Apache-2.0
// Both schemes against their own closed forms, and what the integrator does where they fail.
#include "solver/integrator.h"

#include "tests/cpp/allocations.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::solver {
namespace {

double energy_of(const Problem& problem) {
  return problem.kinetic_energy() + problem.potential_energy(problem.position.data());
}

/// A bead of 2 kg on a spring of 50 N/m along x, 0.1 m out of its place: omega = 5.
struct Oscillator {
  static constexpr double omega = 5, amplitude = 0.1, h = 0.04;
  Problem problem;
  Integrator integrator;
  std::uint32_t bead;

  Oscillator() {
    const auto hook = add_point(problem, {});
    bead = add_point(problem, {1 + amplitude, 0, 0}, 2);
    nail(problem, hook);
    add_spring(problem, hook, bead, 2 * omega * omega, 1);
    integrator.compile(problem);
  }
  double stretch() const { return problem.position[bead].x - 1; }
};

/// The mid-point rule turns a linear oscillator by 2 atan(omega h / 2) a step.
TEST(Integrator, mid_point_swings_an_oscillator_with_the_frequency_of_its_scheme_and_keeps_its_energy) {
  Oscillator o;
  const double start = energy_of(o.problem), turn = 2 * std::atan(Oscillator::omega * Oscillator::h / 2);
  for (int n = 1; n <= 200; ++n) {
    const AdvanceReport report = o.integrator.advance(o.problem, Oscillator::h, IntegratorSettings::energy_keeping());
    ASSERT_TRUE(report.converged);
    EXPECT_EQ(report.fallbacks, 0);
    ASSERT_NEAR(o.stretch(), Oscillator::amplitude * std::cos(n * turn), 1e-9);
    ASSERT_NEAR(energy_of(o.problem), start, 1e-11);
  }
}

/// Backward Euler shrinks each swing by 1 / sqrt(1 + (omega h)^2) a step and turns by atan(omega h).
TEST(Integrator, end_point_damps_an_oscillator_by_the_factor_of_its_scheme) {
  Oscillator o;
  const double x = Oscillator::omega * Oscillator::h, shrink = 1 / std::sqrt(1 + x * x);
  double lost = 0;
  const double start = energy_of(o.problem);
  for (int n = 1; n <= 50; ++n) {
    const AdvanceReport report = o.integrator.advance(o.problem, Oscillator::h, IntegratorSettings::robust());
    ASSERT_TRUE(report.converged);
    EXPECT_GE(report.lost, 0);
    EXPECT_EQ(report.dissipated, 0) << "a spring takes nothing; the scheme does";
    lost += report.lost;
    ASSERT_NEAR(o.stretch(), Oscillator::amplitude * std::pow(shrink, n) * std::cos(n * std::atan(x)), 1e-9);
  }
  EXPECT_NEAR(start - energy_of(o.problem), lost, 1e-12) << "what is lost is reported";
}

/// Position of a pendulum after 0.5 s, in so many steps.
Vec3 swing(const IntegratorSettings& settings, int steps) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  const auto hook = add_point(problem, {}), bob = add_point(problem, {1, 0, 0});
  nail(problem, hook);
  add_rod(problem, hook, bob, 1);
  Integrator integrator;
  integrator.compile(problem);
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(integrator.advance(problem, 0.5 / steps, settings).converged);
  return problem.position[bob];
}

TEST(Integrator, mid_point_is_of_second_order_and_end_point_of_first) {
  const Vec3 truth = swing(IntegratorSettings::energy_keeping(), 4000);
  for (const auto& [settings, order] :
       {std::pair{IntegratorSettings::energy_keeping(), 2.0}, std::pair{IntegratorSettings::robust(), 1.0}}) {
    const double coarse = norm(swing(settings, 100) - truth), fine = norm(swing(settings, 200) - truth);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.1);
  }
}

// Heaps that sweeps solve are compiled in each step and seldom analyzed. The places of other contacts were taken for theirs.
TEST(Integrator, does_not_keep_the_places_of_contacts_from_before_a_structure_that_it_did_not_analyze) {
  Problem problem;
  Integrator integrator;
  const auto build = [&](int contacts) {
    problem.clear();
    const std::uint32_t bead = add_point(problem, {}, 1);
    for (int k = 0; k < contacts; ++k) {
      ContactConstraint c;
      for (int arm = 0; arm < 2; ++arm) c.add(arm, bead, 1);
      c.set_directions({Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}});
      c.normal_compliance = c.compliance = 1e-6;
      add(problem, c);
    }
    integrator.compile(problem);
  };
  build(4);
  EXPECT_TRUE(integrator.advance(problem, h, {}).converged);
  build(2);
  build(4);
  EXPECT_FALSE(problem.has_slots());
  EXPECT_TRUE(integrator.advance(problem, h, {}).converged);
}

TEST(Integrator, halves_a_step_in_which_a_link_turns_too_far) {
  for (const auto& [speed, substeps] : {std::pair{5.0, 1}, std::pair{100.0, 2}}) {
    Problem problem;
    const auto a = add_point(problem, {-0.5, 0, 0}, 1, {0, -speed / 2, 0}),
               b = add_point(problem, {0.5, 0, 0}, 1, {0, speed / 2, 0});
    add_rod(problem, a, b, 1);
    Integrator integrator;
    integrator.compile(problem);
    const double start = problem.kinetic_energy();
    const AdvanceReport report = integrator.advance(problem, 1.0 / 60, IntegratorSettings::energy_keeping());
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.fallbacks, 0);
    EXPECT_GE(report.substeps, substeps);
    EXPECT_EQ(report.substeps == 1, substeps == 1);
    EXPECT_NEAR(problem.kinetic_energy(), start, 1e-9 * start);
  }
}

TEST(Integrator, falls_back_to_the_end_point_where_64_parts_are_too_few_and_never_gains) {
  Problem problem;
  const auto a = add_point(problem, {-0.5, 0, 0}, 1, {0, -4000, 0}),
             b = add_point(problem, {0.5, 0, 0}, 1, {0, 4000, 0});
  add_rod(problem, a, b, 1);
  Integrator integrator;
  integrator.compile(problem);
  const double start = problem.kinetic_energy();
  const AdvanceReport report = integrator.advance(problem, 1.0 / 60, IntegratorSettings::energy_keeping());
  EXPECT_GT(report.fallbacks, 0);
  EXPECT_TRUE(is_finite(problem.position[a]) && is_finite(problem.velocity[a]));
  EXPECT_LE(problem.kinetic_energy(), start * (1 + 1e-12));
  EXPECT_NEAR(problem.kinetic_energy() + report.lost, start, 1e-9 * start);
}

TEST(Integrator, closes_a_gap_by_moving_positions_only) {
  Problem problem;
  const auto a = add_point(problem, {}), b = add_point(problem, {1.1, 0, 0});
  add_rod(problem, a, b, 1);
  problem.velocity[a] = problem.velocity[b] = {0, 2, 0};
  Integrator integrator;
  integrator.compile(problem);
  const double start = problem.kinetic_energy();
  const AdvanceReport report = integrator.advance(problem, 1.0 / 60, IntegratorSettings::energy_keeping());
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(norm(problem.position[b] - problem.position[a]), 1, 1e-9);
  EXPECT_LT(norm(problem.velocity[b] - Vec3{0, 2, 0}), 1e-7) << "a gap gives no speed";
  EXPECT_NEAR(problem.kinetic_energy(), start, 1e-9);
}

TEST(Integrator, holds_a_conflict_as_it_is_and_says_so) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  const auto a = add_point(problem, {}), b = add_point(problem, {1, 0, 0}), c = add_point(problem, {2, 0, 0});
  nail(problem, a), nail(problem, c);
  add_rod(problem, a, b, 0.9), add_rod(problem, b, c, 0.9);
  Integrator integrator;
  integrator.compile(problem);
  bool always_converged = true;
  for (int i = 0; i < 60; ++i)
    always_converged =
        integrator.advance(problem, 1.0 / 60, IntegratorSettings::energy_keeping()).converged && always_converged;
  EXPECT_FALSE(always_converged);
  EXPECT_LT(problem.kinetic_energy(), 1e-3) << "it neither shakes nor heats";
  EXPECT_NEAR(problem.position[b].x, 1, 0.02);
  EXPECT_FALSE(integrator.project_positions(problem));
}

TEST(Integrator, projects_positions_and_leaves_velocities) {
  Problem problem = zigzag(5);
  for (Vec3& x : problem.position) x = 1.2 * x;
  for (Vec3& v : problem.velocity) v = {1, 2, 3};
  const std::vector<Vec3> before = problem.velocity;
  Integrator integrator;
  integrator.compile(problem);
  EXPECT_TRUE(integrator.project_positions(problem));
  EXPECT_LT(problem.worst_gap(problem.position.data()), 1e-9);
  EXPECT_EQ(problem.velocity, before);
}

TEST(Integrator, that_is_warm_allocates_nothing_even_where_it_falls_back) {
  Problem problem;
  const auto a = add_point(problem, {-0.5, 0, 0}), b = add_point(problem, {0.5, 0, 0});
  add_rod(problem, a, b, 1);
  Integrator integrator;
  integrator.compile(problem);
  int fallbacks = 0;
  for (int i = 0; i < 4; ++i) {
    problem.position[a] = {-0.5, 0, 0}, problem.position[b] = {0.5, 0, 0};
    problem.velocity[a] = {0, -4000, 0}, problem.velocity[b] = {0, 4000, 0};
    const long before = allocations;
    fallbacks += integrator.advance(problem, 1.0 / 60, IntegratorSettings::energy_keeping()).fallbacks;
    if (i > 0) {
      EXPECT_EQ(allocations - before, 0);
    }
  }
  EXPECT_GT(fallbacks, 0);
}

TEST(Integrator, steps_alike_after_structures_that_were_never_solved) {
  // A point that lies on a floor, and one beside it on a link.
  const auto build = [](Problem& problem, bool is_linked) {
    problem.clear();
    const std::uint32_t node = add_point(problem, {0, 0, 0}, 2), other = add_point(problem, {1, 0.5, 0});
    problem.gravity = {0, -g, 0};
    for (int i = 0; i < (is_linked ? 1 : 3); ++i) {
      ContactConstraint floor;
      floor.nodes = {is_linked ? other : node}, floor.count = 1, floor.first_side = 0;
      floor.weights[0][0] = floor.weights[1][0] = 1;
      floor.set_constant(0, {}), floor.set_constant(1, {});
      floor.set_directions({Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}});
      floor.friction = 0.5, floor.normal_compliance = 1e-8, floor.compliance = 1e-6;
      add(problem, floor);
    }
    if (is_linked) add_rod(problem, node, other, norm(problem.position[node] - problem.position[other]));
  };
  const auto end_of = [&](std::initializer_list<bool> solved_first) {
    Problem problem;
    Integrator integrator;
    for (const bool is_linked : solved_first) {
      build(problem, is_linked), integrator.compile(problem);
      if (is_linked == *solved_first.begin())
        (void)integrator.advance(problem, h, IntegratorSettings::energy_keeping());
    }
    build(problem, false), integrator.compile(problem);
    (void)integrator.advance(problem, h, IntegratorSettings::energy_keeping());
    return problem.position;
  };
  const std::vector<Vec3> fresh = end_of({});
  EXPECT_EQ(end_of({false, true}), fresh);
  EXPECT_EQ(end_of({true, false}), fresh);
}

/// A step that took four budgets was followed by the next one, and frames of a whole second took that long.
TEST(Integrator, of_contacts_owes_what_it_has_taken_and_sweeps_where_nothing_is_left) {
  Problem problem;
  for (int i = 0; i < 3; ++i) {
    ContactConstraint floor;
    floor.nodes[0] = add_point(problem, {1.0 * i, 0, 0}, 1, {0, -1, 0});
    floor.count = 1, floor.weights[0][0] = floor.weights[1][0] = 1;
    floor.set_constant(0, {1.0 * i, 0, 0}), floor.set_constant(1, {1.0 * i, 0, 0});
    floor.set_directions({Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}});
    floor.friction = 0.5, floor.normal_compliance = 1e-8, floor.compliance = 1e-6;
    add(problem, floor);
  }
  Integrator integrator;
  integrator.compile(problem);
  IntegratorSettings settings = IntegratorSettings::robust();
  settings.contact_budget = 1e7;
  const AdvanceReport solved = integrator.advance(problem, h, settings);
  EXPECT_FALSE(solved.is_approximate);
  EXPECT_GT(problem.owed_work, 0);
  problem.owed_work = 1e9;
  const AdvanceReport swept = integrator.advance(problem, h, settings);
  EXPECT_TRUE(swept.is_approximate);
  EXPECT_EQ(swept.iterations, 0);
}

}  // namespace
}  // namespace iota::solver
