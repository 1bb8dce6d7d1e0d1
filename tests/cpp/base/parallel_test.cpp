// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace iota {
namespace {

TEST(Parallel, does_every_piece_of_work_once) {
  for (const int threads : {1, 2, 4}) {
    const Parallel parallel(threads);
    for (const std::size_t count : {0, 1, 499, 500}) {
      for (const std::size_t grain : {1, 7, 1000}) {
        std::vector<std::atomic<int>> done(count);
        parallel.for_each(count, grain, [&](std::size_t i) { ++done[i]; });
        for (const auto& times : done) EXPECT_EQ(times, 1);
      }
    }
  }
}

TEST(Parallel, with_one_thread_works_in_order_on_the_callers) {
  const Parallel parallel(1);
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<std::size_t> order;
  parallel.for_each(100, 1, [&](std::size_t i) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(i);
  });
  std::vector<std::size_t> expected(100);
  std::iota(expected.begin(), expected.end(), std::size_t{0});
  EXPECT_EQ(order, expected);
}

TEST(Parallel, work_that_fits_into_one_grain_stays_on_the_callers_thread) {
  const Parallel parallel(4);
  const std::thread::id caller = std::this_thread::get_id();
  parallel.for_each(8, 8, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(Parallel, takes_all_cores_for_zero_and_refuses_numbers_that_make_no_sense) {
  EXPECT_EQ(Parallel(0).threads(), available_threads());
  EXPECT_GE(available_threads(), 1);
  EXPECT_EQ(Parallel(3).threads(), 3);
  EXPECT_THROW(Parallel(-1), std::invalid_argument);
  EXPECT_THROW(Parallel(1025), std::invalid_argument);
}

TEST(Parallel, that_was_moved_works_on) {
  Parallel parallel(2);
  std::atomic<int> sum{0};
  parallel.for_each(100, 1, [&](std::size_t i) { sum += static_cast<int>(i); });
  const Parallel other = std::move(parallel);
  other.for_each(100, 1, [&](std::size_t i) { sum += static_cast<int>(i); });
  EXPECT_EQ(sum, 2 * 4950);
}

}  // namespace
}  // namespace iota
