// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace iota {

/// The time of steps by their parts, s. Islands may be solved on several threads: their times are summed.
struct StepTimes {
  double forces = 0;     ///< held forces; forces and constraints in the equations of a step
  double analyze = 0;    ///< islands, and the structure of their matrices; only after changes
  double factor = 0;     ///< assembling and factoring matrices, with the first half of the solution for one right side
  double solve = 0;      ///< the other solutions with these factors
  double integrate = 0;  ///< all else: loading and storing islands, guesses, energies, edits, the report
  double total() const { return forces + analyze + factor + solve + integrate; }
};

/// While it exists, all steps that its thread takes, of any system, add their times. They read the clock several times an
/// iteration; other steps never do.
///
///     StepTimes times;
///     {
///       const TimedSteps timed(times);
///       system.step(1.0 / 120);
///     }
class TimedSteps {
 public:
  explicit TimedSteps(StepTimes&);
  ~TimedSteps();
  TimedSteps(const TimedSteps&) = delete;
  TimedSteps& operator=(const TimedSteps&) = delete;

 private:
  StepTimes* const outer_;
};

}  // namespace iota
