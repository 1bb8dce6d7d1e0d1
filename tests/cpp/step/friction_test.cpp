// SPDX-License-Identifier: Apache-2.0
// Joints whose slide rubs by the reaction of its line.
#include "energy_book.h"
#include "gravity.h"
#include "modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace iota {
namespace {

constexpr double slope = 0.5, step_length = 1.0 / 120;

/// A box of 3 kg, or a particle, on a rail in the world that falls by the angle `slope`, turned about the vertical.
struct Rail {
  System system;
  BodyId slider;
  ConstraintId joint;
  double mass = 3;

  Rail(IntegrationMode mode, ConstraintKind kind, double coefficient, bool is_point = false)
      : system(SystemOptions{.mode = mode}) {
    const Vec3 down{std::cos(slope) * std::cos(0.7), -std::sin(slope), std::cos(slope) * std::sin(0.7)};
    if (is_point) {
      slider = system.bodies().create();
      system.particles().create(slider, {0.4, 0.1, 0}, mass);
    } else {
      slider = system.bodies().create(Box{{0.3, 0.2, 0.1}}, {.mass = mass, .position = {0.4, 0.1, 0}});
    }
    joint = system.joints().create(JointSpec{
        .kind = kind, .a = slider, .at = {0.4, 0.1, 0}, .axis = down, .slide = {.friction_coefficient = coefficient}});
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      const StepReport report = system.step(step_length);
      ASSERT_EQ(report.unconverged, 0);
      ASSERT_LT(report.worst_gap, 1e-7);
    }
  }
  double slide() const { return system.joints().state(joint).coordinate[1]; }
  double speed() const { return system.joints().state(joint).speed[1]; }
  double friction() const { return system.joints().state(joint).effort[1].friction; }
};

TEST(FrictionOfSlides, decides_whether_a_slider_sticks_and_how_it_accelerates) {
  struct Kind {
    ConstraintKind kind;
    bool is_point;
  };
  for (const IntegrationMode mode : all_modes)
    for (const auto& [kind, is_point] :
         {Kind{ConstraintKind::prismatic, false}, Kind{ConstraintKind::cylindrical, true}})
      for (const double coefficient : {0.2, 0.9}) {
        SCOPED_TRACE(coefficient);
        Rail rail(mode, kind, coefficient, is_point);
        const double before = book(rail.system), reaction = rail.mass * g * std::cos(slope);
        const int steps = 120;
        rail.run(steps);
        if (coefficient > std::tan(slope)) {
          EXPECT_NEAR(rail.slide(), 0, 1e-8);
          EXPECT_NEAR(rail.friction(), -rail.mass * g * std::sin(slope), 1e-4);
          EXPECT_NEAR(rail.system.energy().dissipated, 0, 1e-6);
        } else {
          const double a = g * (std::sin(slope) - coefficient * std::cos(slope));
          EXPECT_NEAR(rail.speed(), a * steps * step_length, 1e-5);
          EXPECT_NEAR(rail.friction(), -coefficient * reaction, 1e-4);
          EXPECT_NEAR(rail.system.energy().dissipated, coefficient * reaction * rail.slide(), 1e-4);
        }
        EXPECT_NEAR(book(rail.system), before, 1e-7);
      }
}

TEST(FrictionOfSlides, changes_while_it_runs_and_ends_with_a_coefficient_of_zero) {
  Rail rail(IntegrationMode::energy_keeping, ConstraintKind::prismatic, 2);
  rail.run(10);
  EXPECT_NEAR(rail.speed(), 0, 1e-9);
  const auto set = [&](double coefficient) {
    CoordinateOptions options = rail.system.joints().coordinate(rail.joint, JointCoordinate::slide);
    options.friction_coefficient = coefficient;
    rail.system.joints().set_coordinate(rail.joint, JointCoordinate::slide, options);
  };
  set(0);
  rail.run(60);
  EXPECT_NEAR(rail.speed(), g * std::sin(slope) * 60 * step_length, 1e-6);
  EXPECT_EQ(rail.friction(), 0);
  set(0.3);
  const double before = rail.speed();
  rail.run(60);
  EXPECT_NEAR(rail.speed() - before, g * (std::sin(slope) - 0.3 * std::cos(slope)) * 60 * step_length, 1e-6);
  set(3);
  rail.run(240);
  EXPECT_NEAR(rail.speed(), 0, 1e-9);
}

TEST(FrictionOfSlides, is_restored_from_a_snapshot_to_the_same_bits) {
  Rail rail(IntegrationMode::robust, ConstraintKind::prismatic, 0.3);
  rail.run(20);
  const Snapshot snapshot = rail.system.snapshot();
  rail.run(20);
  System restored;
  restored.restore(snapshot);
  for (int i = 0; i < 20; ++i) (void)restored.step(step_length);
  EXPECT_EQ(restored.state_hash(), rail.system.state_hash());
  EXPECT_EQ(restored.joints().coordinate(rail.joint, JointCoordinate::slide).friction_coefficient, 0.3);
}

TEST(FrictionOfSlides, is_in_the_load_of_the_joint) {
  Rail rail(IntegrationMode::energy_keeping, ConstraintKind::prismatic, 2);
  rail.run(20);
  const Vec3 force = rail.system.joints().state(rail.joint).force;
  EXPECT_NEAR(norm(force - Vec3{0, rail.mass * g, 0}), 0, 1e-4) << "it carries the slider";
}

TEST(FrictionOfSlides, is_refused_where_no_line_alone_guides_the_slide) {
  System system;
  const BodyId box = system.bodies().create(Box{{1, 1, 1}});
  const CoordinateOptions rubs{.friction_coefficient = 0.5};
  for (const ConstraintKind kind : {ConstraintKind::screw, ConstraintKind::revolute})
    EXPECT_THROW(system.joints().create(JointSpec{.kind = kind, .a = box, .lead = 0.1, .angle = {}, .slide = rubs}),
                 std::invalid_argument);
  EXPECT_THROW(system.joints().create(JointSpec{.kind = ConstraintKind::cylindrical, .a = box, .angle = rubs}),
               std::invalid_argument);
  EXPECT_THROW(system.joints().create(
                   JointSpec{.kind = ConstraintKind::prismatic, .a = box, .slide = {.friction_coefficient = -0.1}}),
               std::invalid_argument);
  const ParticleId particle = system.particles().create(system.bodies().create(), {3, 0, 0});
  EXPECT_THROW(system.joints().create(PathSpec{.particle = particle, .points = {{3, 0, 0}, {4, 0, 0}}, .slide = rubs}),
               std::invalid_argument);
  const ConstraintId rail =
      system.joints().create(JointSpec{.kind = ConstraintKind::prismatic, .a = box, .slide = rubs});
  EXPECT_THROW(system.joints().set_compliance(rail, {.linear = 1e-3}), std::invalid_argument);
  system.joints().set_coordinate(rail, JointCoordinate::slide, {});
  system.joints().set_compliance(rail, {.linear = 1e-3});
  EXPECT_THROW(system.joints().set_coordinate(rail, JointCoordinate::slide, rubs), std::invalid_argument);
}

}  // namespace
}  // namespace iota
