// SPDX-License-Identifier: Apache-2.0
#include "edit/attributes.h"
#include "tests/cpp/refused.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace iota {
namespace {

struct One {
  System system{SystemOptions{.gravity = {}}};
  ParticleId p = system.particles().create(system.bodies().create(), {}, 3);
  Particles particles = system.particles();
};

TEST(Orientation, when_it_is_given_comes_with_the_moment_of_a_ball) {
  One small, large;
  small.particles.set_orientation(small.p, {0, 0, 0, 1});
  EXPECT_DOUBLE_EQ(small.particles.moment(small.p), 0.4 * 3 * 0.05 * 0.05) << "without a radius, of 5 cm";
  large.particles.set_attributes(large.p, {.radius = 0.2});
  large.particles.set_orientation(large.p, {0, 0, 0, 2});
  EXPECT_DOUBLE_EQ(large.particles.moment(large.p), 0.4 * 3 * 0.2 * 0.2);
  EXPECT_DOUBLE_EQ(large.particles.orientation(large.p).w, 1) << "a unit quaternion";
  large.particles.set_moment(large.p, 7);
  large.particles.set_orientation(large.p, {1, 0, 0, 0});
  EXPECT_EQ(large.particles.moment(large.p), 7) << "only the first orientation brings one";
}

TEST(Orientation, is_needed_for_all_that_turns_and_its_numbers_are_checked) {
  One one;
  const auto refused = [&](const std::function<void()>& call, const char* words) {
    expect_refused(one.system, call, words);
  };
  refused([&] { one.particles.set_spin(one.p, {}); }, "spin needs an oriented particle");
  refused([&] { one.particles.apply_torque(one.p, {}); }, "a torque needs an oriented particle");
  refused([&] { one.particles.set_moment(one.p, 1); }, "moment needs an oriented particle");
  refused([&] { one.particles.set_spin_damping(one.p, 1); }, "spin damping needs an oriented particle");
  refused([&] { one.particles.align(one.p, {1, 0, 0}, 1, 1); }, "a preferred direction needs an oriented particle");
  refused([&] { one.particles.set_orientation(one.p, {0, 0, 0, 0}); }, "orientation");
  refused([&] { one.particles.set_attributes(one.p, {.lifetime = 0}); }, "lifetime must be above 0");
  refused([&] { one.particles.set_attributes(one.p, {.radius = -1}); }, "radius");
  refused([&] { one.particles.set_attributes(one.p, {.age = -1}); }, "age");
  one.particles.set_orientation(one.p, {0, 0, 0, 1});
  refused([&] { one.particles.align(one.p, {0, 0, 0}, 1, 1); }, "the length of the preferred direction");
  refused([&] { one.particles.set_moment(one.p, 0); }, "moment");
  refused([&] { one.particles.set_spin(one.p, {0, std::nan(""), 0}); }, "spin");
}

}  // namespace
}  // namespace iota
