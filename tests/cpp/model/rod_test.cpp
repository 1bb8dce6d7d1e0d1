// SPDX-License-Identifier: Apache-2.0
#include <iota/system.h>

#include <gtest/gtest.h>

namespace iota {
namespace {

/// A solid cylinder has m r^2 / 2 about its axis and m (3 r^2 + L^2) / 12 across.
TEST(Rod, has_the_moments_of_inertia_of_a_cylinder_over_decades_of_size_and_mass) {
  for (const double mass : {1e-6, 1.0, 1e6})
    for (const double length : {1e-3, 1.0, 1e3})
      for (const double thickness : {0.01, 0.3, 1.0}) {
        System system{SystemOptions{.gravity = {}}};
        const BodyId rod = system.bodies().create();
        const double radius = thickness * length;
        (void)system.particles().create(rod, {});
        (void)system.particles().create(rod, {0.6 * length, 0.8 * length, 0});
        system.bodies().set_rod(rod, mass, radius);
        const double along = mass * radius * radius / 2, across = mass * (3 * radius * radius + length * length) / 12;
        system.bodies().set_angular_velocity(rod, {3, 4, 0});  // along its axis
        EXPECT_NEAR(system.energy().kinetic, 0.5 * along * 25, 1e-9 * along * 25) << length << " " << thickness;
        EXPECT_LT(norm(system.angular_momentum() - along * Vec3{3, 4, 0}), 1e-9 * along * 5);
        system.bodies().set_angular_velocity(rod, {4, -3, 2});
        EXPECT_NEAR(system.energy().kinetic, 0.5 * across * 29, 1e-9 * across * 29) << length << " " << thickness;
      }
}

}  // namespace
}  // namespace iota
