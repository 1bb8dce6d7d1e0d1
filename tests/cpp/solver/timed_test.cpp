// SPDX-License-Identifier: Apache-2.0
// Where the time of steps goes, as measured from outside.
#include "scenes/chain.h"

#include <iota/step_times.h>
#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

namespace iota {
namespace {

double seconds_of(auto work) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - began).count();
}

/// Of `count` chains of 50 links that swing.
System make_chains(int count, int threads) {
  System system;
  system.set_threads(threads);
  for (int i = 0; i < count; ++i)
    (void)scenes::make_chain(system, {.links = 50, .top = {0, 0, 1.0 * i}, .direction = {1, 0, 0}});
  (void)system.step(1.0 / 240);
  return system;
}

TEST(TimedSteps, add_up_to_the_time_that_passes) {
  System system = make_chains(4, 1);
  StepTimes times;
  double outside = 0;
  {
    const TimedSteps timed(times);
    outside = seconds_of([&] { (void)system.step(1.0 / 240, 50); });
  }
  EXPECT_LE(times.total(), outside);
  EXPECT_GT(times.total(), 0.8 * outside);
  for (const double part : {times.forces, times.factor, times.solve, times.integrate}) EXPECT_GT(part, 0);
}

TEST(TimedSteps, count_the_analysis_only_after_changes) {
  System system = make_chains(4, 1);
  StepTimes calm, changed;
  {
    const TimedSteps timed(calm);
    (void)system.step(1.0 / 240);
  }
  for (int i = 0; i < 200; ++i) (void)scenes::make_chain(system, {.links = 20, .top = {0, 0, -1.0 * i}});
  {
    const TimedSteps timed(changed);
    (void)system.step(1.0 / 240);
  }
  EXPECT_GT(changed.analyze, 10 * calm.analyze);
}

TEST(TimedSteps, count_nothing_outside_of_their_scope_or_for_another_scope) {
  System system = make_chains(1, 1);
  StepTimes outer, inner;
  {
    const TimedSteps timed(outer);
    {
      const TimedSteps nested(inner);
      (void)system.step(1.0 / 240);
    }
    EXPECT_EQ(outer.total(), 0);
    (void)system.step(1.0 / 240);
  }
  const double before = outer.total(), before_inner = inner.total();
  EXPECT_GT(before, 0);
  EXPECT_GT(before_inner, 0);
  (void)system.step(1.0 / 240);
  EXPECT_EQ(outer.total(), before);
  EXPECT_EQ(inner.total(), before_inner);
}

TEST(TimedSteps, are_those_of_all_threads) {
  System system = make_chains(64, 4);
  StepTimes times;
  {
    const TimedSteps timed(times);
    (void)system.step(1.0 / 240, 20);
  }
  StepTimes alone;
  System other = make_chains(64, 1);
  {
    const TimedSteps timed(alone);
    (void)other.step(1.0 / 240, 20);
  }
  for (const double StepTimes::* part : {&StepTimes::forces, &StepTimes::factor}) {
    EXPECT_GT(times.*part, 0.4 * alone.*part);
    EXPECT_LT(times.*part, 10 * alone.*part) << "threads that wait for a core count its time";
  }
  EXPECT_GT(times.integrate, 0);
  EXPECT_EQ(system.state_hash(), other.state_hash()) << "timing changes nothing";
}

}  // namespace
}  // namespace iota
