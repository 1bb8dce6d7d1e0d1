// SPDX-License-Identifier: Apache-2.0
// The error of mode accurate by forces that are held over a step: against the motion at a tenth of the step.
#include "held/held_force_error.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace iota {
namespace {

TEST(HeldForceError, of_a_field_that_changes_over_a_step_is_told_of_second_order_and_only_in_mode_accurate) {
  const auto told = [](IntegrationMode mode, double h) {
    System system({.gravity = {}, .mode = mode});
    const BodyId rod = system.bodies().create();
    (void)system.particles().create(rod, {0, 0, 0}, 1, {1, 0, 0});
    (void)system.particles().create(rod, {0, 1, 0}, 1, {1, 0, 0});
    (void)system.fields().create("fx = -30*x");
    double largest = 0;
    for (int i = 0; i < std::lround(1 / h); ++i) largest = std::max(largest, system.step(h).error);
    return largest;
  };
  const double coarse = told(IntegrationMode::accurate, 1.0 / 60), fine = told(IntegrationMode::accurate, 1.0 / 120);
  EXPECT_GT(coarse, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
  EXPECT_EQ(told(IntegrationMode::energy_keeping, 1.0 / 60), 0);
}

TEST(HeldForceError, of_a_field_across_the_velocity_whose_strength_depends_on_the_place_is_told_of_bodies) {
  const auto end = [](double h, double& told) {
    System system({.gravity = {}, .mode = IntegrationMode::accurate});
    const BodyId box =
        system.bodies().create(Box{{0.6, 0.4, 0.2}}, {.density = 40, .position = {1, 0, 0}, .velocity = {0, 1, 0}});
    (void)system.fields().create("fx = c*vy*y*m; fy = -c*vx*y*m; fz = 0", {.parameters = {{"c", 5.0}}});
    for (int i = 0; i < std::lround(2 / h); ++i) told += h * system.step(h).error;
    return system.bodies().center_of_mass(box);
  };
  double told = 0, of_fine = 0;
  const double off = norm(end(1.0 / 60, told) - end(1.0 / 960, of_fine));
  EXPECT_GT(off, 1e-5);
  EXPECT_GT(told, off);
  EXPECT_LT(told, 20 * off);
}

/// By the mass of its point, which has none of its own, it was 5000 times too large.
TEST(HeldForceError, of_bonds_between_attachments_is_that_of_their_bodies) {
  const auto end = [](double h, bool on_attachments, double& told) {
    System system({.gravity = {}, .mode = IntegrationMode::accurate});
    ParticleId ends[2];
    BodyId first{};
    for (const int k : {0, 1}) {
      const double side = k == 0 ? -1 : 1;
      const BodyId box = system.bodies().create(Box{{0.6, 0.4, 0.2}}, {.mass = 2,
                                                                       .position = {side, 0, 0},
                                                                       .velocity = {0, -0.5 * side, 0},
                                                                       .spin = {0.1, 0.2, 0.3},
                                                                       .attachments = {{0, 0.3 * side, 0}}});
      ends[k] = on_attachments ? system.bodies().attachments(box)[0] : system.bodies().particles(box)[0];
      if (k == 0) first = box;
    }
    const LawId law = system.laws().create("energy = 0.5*k*(r - 1)^2", {"held spring", {{"k", 4}}});
    (void)system.bonds().create(ends[0], ends[1], SharedLaw{law, {}, false});
    for (int i = 0; i < std::lround(1 / h); ++i) told += h * system.step(h).error;
    return system.bodies().center_of_mass(first);
  };
  for (const bool on_attachments : {true, false}) {
    double told = 0, of_fine = 0;
    const double off = norm(end(1.0 / 60, on_attachments, told) - end(1.0 / 960, on_attachments, of_fine));
    EXPECT_GT(told, off) << on_attachments;
    EXPECT_LT(told, 300 * off) << on_attachments;
  }
}

TEST(HeldForceError, of_a_fall_with_drag_is_that_of_its_place_although_its_velocity_is_exact) {
  constexpr double drag = 0.05, g = 9.81, h = 1.0 / 60;
  System system({.mode = IntegrationMode::accurate});
  const ParticleId particle = system.particles().create(system.bodies().create(), {}, 2);
  (void)system.fields().create("fx = -m*c*vx; fy = -m*c*vy; fz = -m*c*vz", {.parameters = {{"c", drag}}});
  double told = 0;
  for (int i = 0; i < 60; ++i) told += h * system.step(h).error;
  const double speed = g / drag * (1 - std::exp(-drag)), fallen = (g - speed) / drag;
  EXPECT_NEAR(norm(system.particles().velocity(particle)) / speed, 1, 1e-12);
  const double off = std::abs(norm(system.particles().position(particle)) - fallen);
  EXPECT_GT(off, 1e-6);
  EXPECT_NEAR(told / off, 1, 0.1);
}

}  // namespace
}  // namespace iota
