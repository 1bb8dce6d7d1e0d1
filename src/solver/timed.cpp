// SPDX-License-Identifier: Apache-2.0
#include "solver/timed.h"

#include <atomic>
#include <utility>

namespace iota {

namespace {

// Most steps are not timed: a look at the count is cheaper than one at a variable of the thread.
std::atomic<int> timed_threads = 0;
thread_local StepTimes* thread_times = nullptr;

}  // namespace

TimedSteps::TimedSteps(StepTimes& times) : outer_(std::exchange(thread_times, &times)) {
  timed_threads.fetch_add(1, std::memory_order_relaxed);
}

TimedSteps::~TimedSteps() {
  timed_threads.fetch_sub(1, std::memory_order_relaxed);
  thread_times = outer_;
}

StepTimes* solver::times_of_thread() {
  return timed_threads.load(std::memory_order_relaxed) == 0 ? nullptr : thread_times;
}

}  // namespace iota
