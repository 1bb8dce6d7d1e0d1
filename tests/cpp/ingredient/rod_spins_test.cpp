// SPDX-License-Identifier: Apache-2.0
// Rods that spin about themselves: two points and one more number, against what tops do.
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace iota {
namespace {

constexpr double mass = 2, radius = 0.1, length = 0.8;
constexpr double axial = mass * radius * radius / 2;
constexpr double transverse = mass * (3 * radius * radius + length * length) / 12;

struct Rod {
  System system;
  BodyId body = system.bodies().create();
  ParticleId p = system.particles().create(body, {0, 0, 0}, mass / 2);
  ParticleId q = system.particles().create(body, {length, 0, 0}, mass / 2);

  explicit Rod(const Vec3& gravity = {}, IntegrationMode mode = IntegrationMode::energy_keeping)
      : system({.gravity = gravity, .mode = mode}) {
    system.bodies().set_rod(body, mass, radius);
  }
  Vec3 axis() const { return (1 / length) * (system.particles().position(q) - system.particles().position(p)); }
};

TEST(Spin, a_rod_has_the_angular_velocity_inertia_and_momentum_of_a_cylinder) {
  Rod rod;
  const Vec3 w{30, 2, -1};
  rod.system.bodies().set_angular_velocity(rod.body, w);
  expect_near(rod.system.bodies().angular_velocity(rod.body), w, 1e-12);
  expect_near(rod.system.bodies().angular_momentum(rod.body), {axial * 30, transverse * 2, -transverse}, 1e-12);
  EXPECT_NEAR(rod.system.bodies().inertia(rod.body)[0].x, axial, 1e-14);
  const Energy e = rod.system.energy();
  EXPECT_NEAR(e.kinetic, 0.5 * (axial * 900 + transverse * 5), 1e-12);
  EXPECT_NEAR(e.kinetic, e.edits, 1e-12);
  EXPECT_TRUE(rod.system.validate().empty());
}

TEST(Spin, a_free_rod_precesses_about_its_angular_momentum_and_keeps_it) {
  Rod rod;
  System& system = rod.system;
  system.bodies().set_angular_velocity(rod.body, {200, 0, 4});
  const Vec3 momentum = system.bodies().angular_momentum(rod.body);
  const double energy = system.energy().kinetic, period = 2 * std::numbers::pi * transverse / norm(momentum);
  const double slant = dot(rod.axis(), momentum);
  constexpr int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    (void)system.step(period / steps);
    EXPECT_NEAR(dot(rod.axis(), momentum), slant, 1e-9 * norm(momentum));
  }
  expect_near(rod.axis(), {1, 0, 0}, 1e-5);
  expect_near(system.bodies().angular_momentum(rod.body), momentum, 1e-10);
  EXPECT_NEAR(system.energy().kinetic, energy, 1e-10 * energy);
}

TEST(Spin, a_gyroscope_held_at_one_end_goes_round_at_the_rate_that_its_weight_asks) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust}) {
    Rod rod({0, -9.81, 0}, mode);
    System& system = rod.system;
    const double spin = 400, rate = mass * 9.81 * (length / 2) / (axial * spin);
    system.bodies().set_velocity(rod.body, {0, 0, -rate * length / 2});
    system.bodies().set_angular_velocity(rod.body, {spin, rate, 0});
    system.particles().nail(rod.p);
    const double seconds = 0.5, h = 1.0 / 2000;
    for (int i = 0; i < seconds / h; ++i) (void)system.step(h);
    const double tolerance = mode == IntegrationMode::robust ? 0.01 : 1e-4;
    expect_near(rod.axis(), {std::cos(rate * seconds), 0, -std::sin(rate * seconds)}, tolerance);
    expect_near(system.particles().hinge_force(rod.p),
                Vec3{0, mass * 9.81, 0} - (mass * rate * rate * length / 2) * rod.axis(), 0.02 * mass * 9.81);
    expect_near(system.bodies().net_torque(rod.body), cross({0, rate, 0}, axial * spin * rod.axis()),
                0.02 * mass * 9.81);
  }
}

TEST(Spin, a_rod_moves_as_the_solid_cylinder_does) {
  Rod rod({0, -9.81, 0});
  System solid({.gravity = {0, -9.81, 0}});
  const BodyId body = solid.bodies().create(
      Cylinder{radius, length},
      {.mass = mass, .position = {length / 2, 0, 0}, .attachments = {{-length / 2, 0, 0}, {length / 2, 0, 0}}});
  const auto ends = solid.bodies().attachments(body);
  rod.system.particles().nail(rod.p), solid.particles().nail(ends[0]);
  const Vec3 w{100, 1, 3};
  rod.system.bodies().set_angular_velocity(rod.body, w), solid.bodies().set_angular_velocity(body, w);
  rod.system.bodies().set_velocity(rod.body, cross(w, {length / 2, 0, 0}));
  solid.bodies().set_velocity(body, cross(w, {length / 2, 0, 0}));
  for (int i = 0; i < 2000; ++i) (void)rod.system.step(1.0 / 4000), (void)solid.step(1.0 / 4000);
  expect_near(rod.system.particles().position(rod.q), solid.particles().position(ends[1]), 2e-3);
}

TEST(Spin, locked_to_another_body_its_momentum_goes_into_the_whole) {
  Rod rod;
  System& system = rod.system;
  const BodyId other = system.bodies().create();
  const ParticleId at = system.particles().create(other, {length, 0, 0});
  (void)system.particles().create(other, {length, 1, 0}), (void)system.particles().create(other, {length, 0, 1});
  system.bodies().set_angular_velocity(rod.body, {50, 0, 0});
  (void)system.edits().combine(rod.q, at);
  const Vec3 momentum = system.angular_momentum();
  const RestructureReport report = system.edits().combine(rod.q, at);
  expect_near(system.angular_momentum(), momentum, 1e-12);
  EXPECT_LT(report.energy_change, 0);
  EXPECT_TRUE(system.validate().empty());
  (void)system.step(0.01);
  expect_near(system.angular_momentum(), momentum, 1e-11);
}

TEST(Spin, is_drawn_damped_saved_and_lost_with_its_shape) {
  Rod rod;
  System& system = rod.system;
  system.bodies().set_angular_velocity(rod.body, {1, 0, 0});
  const Snapshot start = system.snapshot();
  for (int i = 0; i < 100; ++i) (void)system.step(0.01);
  const Quaternion turned = system.bodies().orientation(rod.body);
  EXPECT_NEAR(std::abs(turned.x), std::sin(0.5), 1e-9);
  EXPECT_NEAR(std::abs(turned.w), std::cos(0.5), 1e-9);
  system.restore(start);
  system.bodies().set_damping(rod.body, 2);
  for (int i = 0; i < 100; ++i) (void)system.step(0.01);
  EXPECT_NEAR(system.bodies().angular_velocity(rod.body).x, std::exp(-2), 1e-12);
  const Energy e = system.energy();
  EXPECT_NEAR(e.kinetic + e.dissipated - e.edits, 0, 1e-12);
  (void)system.particles().create(rod.body, {0, 1, 0});  // a plate now
  EXPECT_TRUE(system.validate().empty());
  (void)system.step(0.01);
  EXPECT_NEAR(system.energy().kinetic, 0, 1e-12);
}

}  // namespace
}  // namespace iota
