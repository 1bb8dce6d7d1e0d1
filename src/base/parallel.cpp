// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <stdexcept>
#include <string>

#ifdef IOTA_HAS_TBB
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#elif defined(__SANITIZE_THREAD__)
#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace iota {

#ifdef IOTA_HAS_TBB

int available_threads() { return oneapi::tbb::info::default_concurrency(); }

struct Parallel::Arena {
  explicit Arena(int threads) : arena(threads) {
    // Allows more threads than cores on request; otherwise oneTBB would use fewer and warn.
    if (threads > available_threads())
      static const oneapi::tbb::global_control allow(oneapi::tbb::global_control::max_allowed_parallelism, 1024);
  }
  oneapi::tbb::task_arena arena;
};

void Parallel::run(std::size_t count, std::size_t grain, void* work, void (*call)(void*, std::size_t)) const {
  if (!arena_) arena_ = std::make_unique<Arena>(threads_);
  arena_->arena.execute([&] {
    oneapi::tbb::parallel_for(
        oneapi::tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) call(work, i);
        },
        oneapi::tbb::simple_partitioner{});
  });
}

#elif defined(__SANITIZE_THREAD__)

// oneTBB is not instrumented: all that it hands over would look like a race. Threads made for each call are slow.
int available_threads() { return 3; }

struct Parallel::Arena {};

void Parallel::run(std::size_t count, std::size_t grain, void* work, void (*call)(void*, std::size_t)) const {
  std::atomic<std::size_t> next = 0;
  const auto take_tasks = [&] {
    for (std::size_t first = next.fetch_add(grain); first < count; first = next.fetch_add(grain))
      for (std::size_t i = first; i < std::min(first + grain, count); ++i) call(work, i);
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads_; ++i) others.emplace_back(take_tasks);
  take_tasks();
}

#else

int available_threads() { return 1; }

struct Parallel::Arena {};

void Parallel::run(std::size_t count, std::size_t, void* work, void (*call)(void*, std::size_t)) const {
  for (std::size_t i = 0; i < count; ++i) call(work, i);
}

#endif

Parallel::Parallel(int threads) {
  if (threads < 0 || threads > 1024)
    throw std::invalid_argument("threads must be between 1 and 1024, or 0 for all cores, got " +
                                std::to_string(threads));
  threads_ = threads == 0 ? available_threads() : threads;
}
Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;
Parallel& Parallel::operator=(Parallel&&) noexcept = default;

}  // namespace iota
