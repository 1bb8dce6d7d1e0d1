// SPDX-License-Identifier: Apache-2.0
// The promises of motion on random scenes; `make soak` tries 10 000 of each.
#include "scenes/promises.h"
#include "tests/cpp/amount.h"

#include <gtest/gtest.h>

namespace iota::scenes {
namespace {

class Promises : public testing::TestWithParam<Promise> {};

TEST_P(Promises, are_kept_in_random_scenes) {
  const std::uint64_t count = sampled(400);
  for (std::uint64_t seed = 1; seed <= count; ++seed)
    EXPECT_EQ(break_promise(GetParam(), seed).value_or(""), "") << seed;
}

/// A screw far along the axis of a body that turned with it; a motor that slipped, whose heat end-point steps gave to spins.
TEST(BrokenPromises, are_kept_now) {
  EXPECT_EQ(break_promise(Promise::turns, 210290).value_or(""), "");
  EXPECT_EQ(break_promise(Promise::bounds, 200201).value_or(""), "");
}

INSTANTIATE_TEST_SUITE_P(All, Promises,
                         testing::Values(Promise::energy, Promise::velocities, Promise::momenta, Promise::force,
                                         Promise::conflict, Promise::order, Promise::turns, Promise::bounds,
                                         Promise::rescue, Promise::field, Promise::torque),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
}  // namespace iota::scenes
