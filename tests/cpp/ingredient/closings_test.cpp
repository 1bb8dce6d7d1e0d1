// SPDX-License-Identifier: Apache-2.0
#include "ingredient/closings.h"

#include <iota/system.h>

#include <gtest/gtest.h>

namespace iota {
namespace {

/// The distance falls as 1 - 0.99 (3 s^2 - 2 s^3) of the time s from 0 to 1; then the particles are combined.
TEST(Closings, bring_two_particles_together_by_a_smooth_law_about_their_center_of_mass) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping})
    for (const double size : {1e-3, 1.0, 1e3}) {
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      std::vector<ParticleId> near, far;
      for (const double x : {0.0, 3.0}) {
        const BodyId rod = system.bodies().create();
        near.push_back(system.particles().create(rod, {x * size, 0, 0}, 1));
        far.push_back(system.particles().create(rod, {x * size, size, 0}, 1));
      }
      (void)system.edits().combine(near[0], near[1], 1.0);
      EXPECT_EQ(system.edits().closing_count(), 1u);
      constexpr int steps = 64;
      for (int i = 1; i < steps; ++i) {
        (void)system.step(1.0 / steps);
        const double s = static_cast<double>(i) / steps, left = 3 * size * (1 - 0.99 * s * s * (3 - 2 * s));
        const Particles particles = system.particles();
        EXPECT_NEAR(norm(particles.position(near[0]) - particles.position(near[1])), left, 1e-5 * size) << i;
        Vec3 center;
        for (const ParticleId p : {near[0], near[1], far[0], far[1]}) center += 0.25 * particles.position(p);
        EXPECT_LT(norm(center - size * Vec3{1.5, 0.5, 0}), 1e-9 * size) << i;
      }
      for (int i = 0; i < 2; ++i) (void)system.step(1.0 / steps);
      EXPECT_EQ(system.edits().closing_count(), 0u);
      EXPECT_EQ(system.particles().position(near[0]), system.particles().position(near[1]));
      EXPECT_LT(norm(system.momentum()), 1e-9 * size);
      EXPECT_EQ(system.validate(), std::vector<std::string>{});
    }
}

TEST(Closings, are_called_off_by_separate_and_leave_the_particles_where_they_are) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {});
  const ParticleId q = system.particles().create(system.bodies().create(), {1, 0, 0});
  (void)system.edits().combine(p, q, 1.0);
  for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 60);
  (void)system.edits().separate(p, q);
  EXPECT_EQ(system.edits().closing_count(), 0u);
  const double distance = norm(system.particles().position(p) - system.particles().position(q));
  EXPECT_NEAR(distance, 0.505, 1e-5);
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);
  EXPECT_NEAR(norm(system.particles().position(p) - system.particles().position(q)), distance, 1e-9);
}

}  // namespace
}  // namespace iota
