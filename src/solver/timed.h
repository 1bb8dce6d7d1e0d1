// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/step_times.h>

#include <chrono>

namespace iota::solver {

/// The times to which steps of this thread add theirs, see TimedSteps; null: they are not measured.
StepTimes* times_of_thread();

/// Moves the time of its scope from one part of a step to another. Without times no clock is read.
class Timed {
 public:
  using Part = double StepTimes::*;
  static constexpr Part none = nullptr;

  Timed(StepTimes* times, Part to, Part from = &StepTimes::integrate) : times_(times), to_(to), from_(from) {
    if (times_) began_ = Clock::now();
  }
  ~Timed() {
    if (!times_) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    if (to_ != none) times_->*to_ += seconds;
    if (from_ != none) times_->*from_ -= seconds;
  }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  StepTimes* const times_;
  const Part to_, from_;
  Clock::time_point began_;
};

}  // namespace iota::solver
