// SPDX-License-Identifier: Apache-2.0
// The tables of joints under edits, and rows that a joint has without the others.
#include "ingredient/joints.h"

#include "tests/cpp/ingredient/everything.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>

namespace iota {
namespace {

/// A block that turns about a fixed axis through its center.
struct Wheel {
  System system;
  BodyId body;
  ConstraintId joint;
  double inertia;

  Wheel(const CoordinateOptions& angle, IntegrationMode mode) : system({.gravity = {}, .mode = mode}) {
    body = system.bodies().create(Box{{0.4, 0.2, 0.1}}, {.mass = 3});
    inertia = 3 * (0.4 * 0.4 + 0.2 * 0.2) / 12;
    joint = system.joints().create(
        JointSpec{.kind = ConstraintKind::revolute, .a = body, .axis = {0, 0, 1}, .angle = angle});
    system.bodies().set_angular_velocity(body, {0, 0, 2});
  }
  double speed() const { return system.bodies().angular_velocity(body).z; }
};

TEST(Joints, a_dashpot_without_a_spring_slows_exponentially_and_its_loss_is_booked) {
  for (const IntegrationMode mode :
       {IntegrationMode::energy_keeping, IntegrationMode::robust, IntegrationMode::plausible}) {
    const double damping = 0.05;
    Wheel wheel({.damping = damping}, mode);
    const double kinetic = wheel.system.energy().kinetic;
    for (int i = 0; i < 1000; ++i) {
      const StepReport report = wheel.system.step(1e-3);
      ASSERT_EQ(report.unconverged, 0);
    }
    const double left = std::exp(-damping / wheel.inertia);
    EXPECT_NEAR(wheel.speed(), 2 * left, 2e-3);
    const Energy energy = wheel.system.energy();
    EXPECT_EQ(energy.potential, 0);
    EXPECT_NEAR(energy.dissipated, kinetic * (1 - left * left), 1e-2 * kinetic);
    EXPECT_NEAR(energy.kinetic + energy.dissipated + energy.lost - energy.made, kinetic, 1e-9);
    EXPECT_EQ(energy.made, 0);
  }
}

}  // namespace
}  // namespace iota
