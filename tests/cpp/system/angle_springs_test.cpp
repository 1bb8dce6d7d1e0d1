// SPDX-License-Identifier: Apache-2.0
#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace iota {
namespace {

TEST(AngleSprings, refuse_invalid_angles_and_stay_unchanged) {
  System system{SystemOptions{.gravity = {}}};
  std::array<ParticleId, 3> ends;
  for (std::size_t i = 0; i < 3; ++i)
    ends[i] = system.particles().create(system.bodies().create(), {static_cast<double>(i), i == 1 ? 1.0 : 0.0, 0});
  const auto [p, middle, q] = ends;
  AngleSprings springs = system.angle_springs();
  const AngleSpringId spring = springs.create(p, middle, q, {.stiffness = 30});
  EXPECT_NEAR(springs.options(spring).rest, std::numbers::pi / 2, 1e-14) << "the present angle";
  const std::uint64_t before = system.state_hash();
  EXPECT_THROW(springs.create(p, p, q, {}), std::invalid_argument);
  EXPECT_THROW(springs.create(p, middle, p, {}), std::invalid_argument);
  EXPECT_THROW(springs.create(p, middle, q, {.stiffness = -1}), std::invalid_argument);
  EXPECT_THROW(springs.create(p, middle, q, {.damping = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(springs.create(p, middle, q, {.rest = 0}), std::invalid_argument);
  EXPECT_THROW(springs.set(spring, {.stiffness = 1, .rest = 4}), std::invalid_argument);
  EXPECT_EQ(system.state_hash(), before);
  springs.destroy(spring);
  EXPECT_THROW(springs.set(spring, {}), StaleIdError);
}

/// A spring that is changed moves a system that has come to rest.
TEST(AngleSprings, wake_resting_bodies_when_they_are_changed) {
  System system{SystemOptions{.gravity = {}, .rest = {.after = 0.1, .speed = 0.01}}};
  std::array<ParticleId, 3> ends;
  for (std::size_t i = 0; i < 3; ++i)
    ends[i] = system.particles().create(system.bodies().create(), {static_cast<double>(i), i == 1 ? 1.0 : 0.0, 0});
  const AngleSpringId spring = system.angle_springs().create(ends[0], ends[1], ends[2], {.stiffness = 30});
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);
  EXPECT_EQ(system.bodies().kind(system.particles().body(ends[0])), BodyKind::resting);
  system.angle_springs().set(spring, {.stiffness = 30, .rest = 2});
  for (int i = 0; i < 10; ++i) (void)system.step(1.0 / 60);
  EXPECT_GT(system.energy().kinetic, 0.1);
}

}  // namespace
}  // namespace iota
