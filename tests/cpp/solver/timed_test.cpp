// SPDX-License-Identifier: Apache-2.0
// Where the time of steps goes, as measured from outside.
#include "scenes/chain.h"

#include <iota/step_times.h>
#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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
  System system = make_chains(64, 4), other = make_chains(64, 1);
  const auto times_of = [](System& chains) {
    StepTimes times;
    {
      const TimedSteps timed(times);
      (void)chains.step(1.0 / 240, 20);
    }
    return times;
  };
  // Threads that wait for a core count its time: on a busy machine a single measurement says little.
  constexpr int most_tries = 8;
  const auto agree = [&] {
    const StepTimes times = times_of(system), alone = times_of(other);
    EXPECT_GT(times.integrate, 0);
    return std::ranges::all_of(std::array{&StepTimes::forces, &StepTimes::factor}, [&](const auto part) {
      return times.*part > 0.4 * alone.*part && times.*part < 10 * alone.*part;
    });
  };
  bool any = false;
  for (int i = 0; i < most_tries && !any; ++i) any = agree();
  EXPECT_TRUE(any);
  EXPECT_EQ(system.state_hash(), other.state_hash()) << "timing changes nothing";
}

}  // namespace
}  // namespace iota
