// SPDX-License-Identifier: Apache-2.0
// Fields that depend on velocities: the part that is linear in them is taken implicitly.
#include "tests/cpp/modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>

namespace iota {
namespace {

constexpr const char* magnetic = "fx = -m*w*vz; fz = m*w*vx";

TEST(FieldOfVelocities, at_right_angles_to_them_keeps_every_speed_in_every_mode) {
  for (const IntegrationMode mode : all_modes)
    for (const double turn : {0.01, 0.3, 1.0, 3.0}) {  // rad a step
      constexpr double h = 1.0 / 60;
      System system({.gravity = {}});
      system.set_mode(mode);
      const ParticleId p = system.particles().create(system.bodies().create(), {0, 1, 0}, 2, {1, 0.5, 0});
      system.fields().create(magnetic, {.parameters = {{"w", turn / h}}});
      for (int i = 0; i < 300; ++i) (void)system.step(h);
      const Vec3 v = system.particles().velocity(p);
      EXPECT_NEAR(norm(v), std::sqrt(1.25), 1e-12) << "mode " << int(mode) << ", " << turn << " rad a step";
      EXPECT_NEAR(v.y, 0.5, 1e-12);
      const Energy energy = system.energy();
      EXPECT_NEAR(energy.external_work, 0, 1e-11) << "it does no work";
      EXPECT_NEAR(energy.lost, 0, 1e-11);
    }
}

TEST(FieldOfVelocities, at_right_angles_to_them_keeps_the_energy_of_a_double_pendulum) {
  for (const double w : {0.6, 10.0, 120.0}) {
    System system;
    const BodyId upper = system.bodies().create(), lower = system.bodies().create();
    system.particles().nail(system.particles().create(upper, {}));
    const ParticleId elbow = system.particles().create(upper, {1, 0, 0});
    (void)system.edits().combine(elbow, system.particles().create(lower, {1, 0, 0}));
    system.particles().create(lower, {1.6, 0.3, 0.2}, 1, {});
    system.particles().create(lower, {1.2, 0.5, -0.2}, 1, {});
    system.particles().create(lower, {1.3, -0.1, 0.4}, 2, {});  // carried by the others
    system.fields().create(magnetic, {.parameters = {{"w", w}}});
    const double start = system.energy().total();
    for (int i = 0; i < 600; ++i) (void)system.step(1.0 / 120);
    EXPECT_NEAR(system.energy().total(), start, 1e-5) << w;
    EXPECT_NEAR(system.energy().external_work, 0, 1e-9);
  }
}

TEST(FieldOfVelocities, with_a_drag_of_any_size_leaves_a_falling_particle_its_exact_velocity) {
  for (const IntegrationMode mode : all_modes)
    for (const double drag : {0.1, 10.0, 1e3, 1e6})
      for (const bool is_listed : {false, true}) {
        System system;
        system.set_mode(mode);
        const ParticleId p = system.particles().create(system.bodies().create(), {0, 1, 0}, 1, {5, 0, 0});
        if (is_listed)
          system.fields().create("wind", {.parameters = {{"drag", drag}}});
        else
          system.fields().create("fx = -c*vx; fy = -c*vy; fz = -c*vz", {.parameters = {{"c", drag}}});
        for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 30);
        const Vec3 v = system.particles().velocity(p);
        const double left = std::exp(-drag);
        EXPECT_NEAR(v.x, 5 * left, 1e-11) << drag;
        EXPECT_NEAR(v.y, -9.81 / drag * (1 - left), 1e-10) << drag;
      }
}

TEST(FieldOfVelocities, with_a_quadratic_drag_never_reverses_a_motion) {
  for (const IntegrationMode mode : all_modes)
    for (const double drag : {1.0, 1e3, 1e6}) {
      System system({.gravity = {}});
      system.set_mode(mode);
      const BodyId rod = system.bodies().create();
      const ParticleId p = system.particles().create(rod, {0, 0, 0}, 1, {5, 0, 0});
      system.particles().create(rod, {1, 0, 0}, 1, {5, 0, 0});
      system.fields().create("fx = -c*vx*abs(vx)", {.parameters = {{"c", drag}}});
      double before = 5;
      for (int i = 0; i < 100; ++i) {
        (void)system.step(1.0 / 60);
        const double now = system.particles().velocity(p).x;
        const double tolerance = mode == IntegrationMode::accurate ? 1e-3 : 0;
        ASSERT_TRUE(now >= -tolerance && now <= before + tolerance) << now << " after " << before;
        before = now;
      }
    }
}

/// Where a heavy bob on a rod is after 2 s under gravity and the Coriolis force.
Vec3 swing(double hz) {
  System system;
  const BodyId rod = system.bodies().create();
  system.particles().nail(system.particles().create(rod, {}));
  const ParticleId bob = system.particles().create(rod, {0.5, -1.2, 0}, 2, {0, 0, 0.6});
  system.fields().create("fx = -2*m*(wy*vz - wz*vy); fy = -2*m*(wz*vx - wx*vz); fz = -2*m*(wx*vy - wy*vx)",
                         {.parameters = {{"wx", 0.3}, {"wy", 0.8}, {"wz", 0.1}}});
  for (int i = 0; i < 2 * hz; ++i) (void)system.step(1 / hz);
  return system.particles().position(bob);
}

TEST(FieldOfVelocities, is_of_second_order_in_energy_keeping) {
  const Vec3 coarse = swing(60), middle = swing(120), fine = swing(240);
  EXPECT_NEAR(std::log2(norm(coarse - middle) / norm(middle - fine)), 2, 0.05);
}

TEST(FieldOfVelocities, has_its_force_in_the_loads_of_the_bodies) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system({.gravity = {}});
    system.set_mode(mode);
    const BodyId rod = system.bodies().create();
    const ParticleId p = system.particles().create(rod, {0, 0, 0}, 1, {5, 0, 1});
    system.particles().create(rod, {1, 0, 0}, 3, {5, 0, 1});
    system.fields().create("fx = -m*w*vz - 2*m*vx; fz = m*w*vx - 2*m*vz", {.parameters = {{"w", 20}}});
    const Vec3 before = system.particles().velocity(p);
    (void)system.step(1.0 / 60);
    const Vec3 gained = system.particles().velocity(p) - before;
    EXPECT_LT(norm(system.bodies().net_force(rod) - 60 * 4 * gained), 1e-9 * 240 * norm(gained));
  }
}

}  // namespace
}  // namespace iota
