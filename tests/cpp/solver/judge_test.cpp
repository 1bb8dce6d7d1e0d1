// SPDX-License-Identifier: Apache-2.0
// Which made energy is accepted, by whom.
#include "solver/judge.h"

#include <gtest/gtest.h>

namespace iota::solver {
namespace {

/// Of 100 J of motion, of which a step makes some more.
StepEnergy made(double joules) {
  return {.kinetic_before = 100, .total_before = 100, .kinetic = 100 + joules, .total = 100 + joules, .slack = 1e-7};
}
Trial mid_point() { return {.scheme = Scheme::mid_point}; }
Trial end_point() { return {.scheme = Scheme::end_point}; }

TEST(Judge, accepts_every_step_that_loses_energy) {
  for (const double lost : {0.0, 1e-9, 50.0})
    for (const Trial& trial : {mid_point(), end_point()}) EXPECT_EQ(judge(trial, made(-lost)), Verdict::accept);
}

TEST(Judge, lets_the_mid_point_rule_make_little_of_the_motion) {
  EXPECT_EQ(judge(mid_point(), made(3)), Verdict::accept) << "curved rows are not quadratic";
  EXPECT_EQ(judge(mid_point(), made(10)), Verdict::reject);
}

TEST(Judge, has_an_end_point_step_that_makes_energy_solved_finer_and_then_halved) {
  Trial trial = end_point();
  EXPECT_EQ(judge(trial, made(1e-3)), Verdict::refine);
  trial.is_refined = true;
  EXPECT_EQ(judge(trial, made(1e-3)), Verdict::reject);
  EXPECT_EQ(judge(trial, made(1e-8)), Verdict::accept) << "within the tolerance of the solve";
}

TEST(Judge, accepts_more_of_the_shortest_parts_whose_surplus_is_removed) {
  Trial trial = end_point();
  trial.is_refined = trial.is_finest = true;
  EXPECT_EQ(judge(trial, made(5)), Verdict::accept);
  EXPECT_EQ(judge(trial, made(50)), Verdict::reject);
}

TEST(Judge, does_not_count_the_work_of_hands_as_made) {
  Trial trial = end_point();
  trial.is_conservative = false;
  StepEnergy pulled = made(50);
  EXPECT_EQ(judge(trial, pulled), Verdict::reject);
  pulled.external_work = 50;
  EXPECT_EQ(judge(trial, pulled), Verdict::accept);
}

TEST(Judge, rejects_a_driven_step_whose_bodies_jump) {
  Trial trial = mid_point();
  trial.drives_rows = true;
  EXPECT_EQ(judge(trial, made(50)), Verdict::accept) << "the work of a drive is known to first order only";
  EXPECT_EQ(judge(trial, made(-50)), Verdict::accept);
  StepEnergy jump = made(10);
  jump.total = 100 + 1000;
  EXPECT_EQ(judge(trial, jump), Verdict::reject);
}

/// The same step in other units.
TEST(Judge, does_not_depend_on_units) {
  for (const double scale : {1e-24, 1.0, 1e24}) {
    StepEnergy step = made(10);
    for (double* const joules : {&step.kinetic_before, &step.total_before, &step.kinetic, &step.total, &step.slack})
      *joules *= scale;
    EXPECT_EQ(judge(mid_point(), step), Verdict::reject);
  }
}

}  // namespace
}  // namespace iota::solver
