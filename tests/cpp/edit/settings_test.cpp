// SPDX-License-Identifier: Apache-2.0
#include "edit/settings.h"
#include "tests/cpp/refused.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace iota {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Settings, out_of_range_are_refused_by_name_and_change_nothing) {
  System system;
  const auto refused = [&](const std::function<void()>& set, const char* words) { expect_refused(system, set, words); };
  refused([&] { system.set_gravity({0, nan, 0}); }, "gravity");
  for (const double tolerance : {0.0, -1.0, 9e-13, 1.1, nan})
    refused([&] { system.set_tolerance(tolerance); }, "tolerance must be between 1e-12 and 1");
  refused([&] { system.set_budget({.iterations = -1}); }, "budget.iterations");
  refused([&] { system.set_budget({.seconds = -1e-9}); }, "budget.seconds");
  refused([&] { system.set_damping(-1e-9); }, "damping");
  refused([&] { system.set_rest({-1, 0.1}); }, "rest.after");
  refused([&] { system.set_rest({1, nan}); }, "rest.speed");
  refused([&] { system.set_solver("nothing"); }, "or \"direct\", the system's own");
  refused([&] { system.set_solver(""); }, "a name has 1 to");
  refused([&] { system.set_solver(std::string(200, 'x')); }, "a name has 1 to");
}

TEST(Settings, at_the_ends_of_their_ranges_are_kept) {
  System system;
  for (const double tolerance : {1e-12, 1.0}) {
    system.set_tolerance(tolerance);
    EXPECT_EQ(system.tolerance(), tolerance);
  }
  for (const char* const solver : {"newton", "direct"}) {
    system.set_solver(solver);
    EXPECT_EQ(system.solver(), solver);
  }
}

TEST(Settings, of_gravity_wake_resting_bodies) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {});
  system.set_rest({0.1, 0.01});
  for (int i = 0; i < 60; ++i) (void)system.step(0.01);
  ASSERT_EQ(system.bodies().kind(body), BodyKind::resting);
  system.set_gravity({0, -2, 0});
  (void)system.step(0.5);
  EXPECT_NEAR(system.particles().velocity(p).y, -1, 1e-12);
}

}  // namespace
}  // namespace iota
