// SPDX-License-Identifier: Apache-2.0
// Jointed bodies in heaps by sweeps, judged from places and momenta, beside the equations of all rows.
#include "solver/heap_ties.h"

#include "math/mat3.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace iota {
namespace {

/// All steps by sweeps, or none.
System make_tied_world(bool by_sweeps, const Vec3& gravity = {0, -9.81, 0}) {
  System system({.gravity = gravity});
  StepBudget budget = system.budget();
  budget.contacts = by_sweeps ? 1 : 0;
  system.set_budget(budget);
  system.set_usual_material(Material{0.5});
  if (gravity != Vec3{}) system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
  return system;
}
/// The orientation is that of the solid's axes.
Vec3 place_of(const System& system, BodyId body, const Vec3& local) {
  return system.bodies().center_of_mass(body) + rotate(system.bodies().orientation(body), local);
}

/// Capsules in a row, each with a joint to the next one.
struct Row {
  std::vector<BodyId> bodies;

  Row(System& system, ConstraintKind kind, int count, const Vec3& at) {
    for (int i = 0; i < count; ++i) {
      const SolidOptions options{.mass = 2, .position = at + Vec3{0.4 * i, 0, 0}};
      bodies.push_back(system.bodies().create(Capsule{0.05, 0.2}, options));
      if (i > 0)
        (void)system.joints().create(JointSpec{.kind = kind,
                                               .a = bodies[static_cast<std::size_t>(i) - 1],
                                               .b = bodies[static_cast<std::size_t>(i)],
                                               .at = at + Vec3{0.4 * i - 0.2, 0, 0},
                                               .axis = {0, 0, 1}});
    }
  }
  double worst_gap(const System& system) const {
    double worst = 0;
    for (std::size_t i = 1; i < bodies.size(); ++i)
      worst = std::max(worst,
                       norm(place_of(system, bodies[i - 1], {0.2, 0, 0}) - place_of(system, bodies[i], {-0.2, 0, 0})));
    return worst;
  }
};

TEST(HeapTies, leave_joints_closed_and_bodies_where_exact_steps_have_them) {
  for (const ConstraintKind kind : {ConstraintKind::ball, ConstraintKind::revolute, ConstraintKind::universal}) {
    std::vector<std::vector<double>> heights;
    for (const bool by_sweeps : {false, true}) {
      System system = make_tied_world(by_sweeps);
      const Row row(system, kind, 4, {0, 0.4, 0});
      system.bodies().set_angular_velocity(row.bodies[0], {0, 0, 1});
      std::uint64_t swept = 0;
      for (int i = 0; i < 180; ++i) {
        swept += system.step(1.0 / 60).approximate;
        EXPECT_LT(row.worst_gap(system), 1e-9) << i;
      }
      EXPECT_EQ(swept > 100, by_sweeps);
      heights.emplace_back();
      for (const BodyId body : row.bodies) heights.back().push_back(system.bodies().center_of_mass(body).y);
    }
    for (std::size_t i = 0; i < heights[0].size(); ++i) EXPECT_NEAR(heights[0][i], heights[1][i], 0.01) << i;
  }
}

TEST(HeapTies, keep_momenta_of_chains_that_collide_in_space) {
  System system = make_tied_world(true, {});
  const Row one(system, ConstraintKind::ball, 4, {0, 0, 0}), two(system, ConstraintKind::revolute, 4, {0.3, 0.3, 0.05});
  for (const BodyId body : two.bodies) system.bodies().set_velocity(body, {0, -1, 0});
  for (const BodyId body : one.bodies) system.bodies().set_velocity(body, {0.2, 0.5, 0});
  const Vec3 before = system.momentum(), angular = system.angular_momentum();
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);
  EXPECT_LT(norm(system.momentum() - before), 1e-11);
  EXPECT_LT(norm(system.angular_momentum() - angular), 1e-11);
}

TEST(HeapTies, turn_what_a_motor_on_a_loose_stand_turns) {
  System system = make_tied_world(true);
  const BodyId stand = system.bodies().create(Box{{0.4, 0.4, 0.4}}, SolidOptions{.mass = 50, .position = {0, 0.2, 0}});
  const BodyId arm =
      system.bodies().create(Box{{0.3, 0.05, 0.05}}, SolidOptions{.mass = 1, .position = {0, 0.2, 0.26}});
  JointSpec spec{.a = arm, .b = stand, .at = {0, 0.2, 0.26}, .axis = {0, 0, 1}};
  spec.angle.motor_speed = 2, spec.angle.motor_max = 100;
  (void)system.joints().create(spec);
  int swept = 0;
  for (int i = 0; i < 60; ++i) {
    const StepReport report = system.step(1.0 / 60);
    swept += static_cast<int>(report.approximate);
    EXPECT_LT(report.energy.made, 1e-5);
  }
  EXPECT_EQ(swept, 60);
  EXPECT_NEAR(system.bodies().angular_velocity(arm).z - system.bodies().angular_velocity(stand).z, 2, 0.02);
}

TEST(HeapTies, let_a_free_wheel_turn_on_a_stand_that_rests) {
  System system = make_tied_world(true);
  const BodyId stand = system.bodies().create(Box{{0.4, 0.4, 0.2}}, SolidOptions{.mass = 50, .position = {0, 0.2, 0}});
  const Vec3 at{0, 0.2, 0.25};
  const BodyId wheel = system.bodies().create(Sphere{0.1}, SolidOptions{.mass = 1, .position = at});
  (void)system.joints().create(JointSpec{.a = wheel, .b = stand, .at = at, .axis = {0, 0, 1}});
  // Its energy is a 2000th of that which the stand would give in a fall of its size.
  constexpr double speed = 4, weight = 51 * 9.81;
  system.bodies().set_angular_velocity(wheel, {0, 0, speed});
  for (int i = 0; i < 120; ++i) {
    const StepReport report = system.step(1.0 / 60);
    EXPECT_EQ(report.approximate, 1);
    EXPECT_LT(norm(system.bodies().velocity(stand)), 1e-3);
    const double height = (50 * system.bodies().center_of_mass(stand).y + system.bodies().center_of_mass(wheel).y) / 51;
    EXPECT_NEAR(report.energy.potential, weight * height, 1e-9 * weight)
        << "what sweeps hold by friction stores nothing";
  }
  EXPECT_NEAR(system.bodies().angular_velocity(wheel).z, speed, 1e-5 * speed);
}

// What is hinged at a post, too, holds against whoever pulls it: that is no work on it.
TEST(HeapTies, make_no_energy_of_what_scripted_bodies_pull) {
  for (const bool is_held : {false, true}) {
    System system = make_tied_world(true);
    system.set_usual_material(Material{0});
    const BodyId box = system.bodies().create(Box{{0.4, 0.4, 0.4}}, SolidOptions{.mass = 5, .position = {0, 0.2, 0}});
    const BodyId hand = system.bodies().create(Box{{0.1, 0.1, 0.1}}, SolidOptions{.mass = 1, .position = {0, 0.5, 0}});
    const BodyId post =
        system.bodies().create(Box{{0.1, 0.1, 0.1}}, SolidOptions{.mass = 1, .position = {0, 0.2, 0.3}});
    system.bodies().set_kind(hand, BodyKind::scripted), system.bodies().set_kind(post, BodyKind::static_);
    (void)system.joints().create(JointSpec{.a = box, .b = hand, .at = {0, 0.45, 0}, .axis = {0, 0, 1}});
    if (is_held) (void)system.joints().create(JointSpec{.a = box, .b = post, .at = {0, 0.2, 0.25}, .axis = {0, 0, 1}});
    for (int i = 0; i < 30; ++i) {
      system.bodies().set_pose(hand, {(i + 1) / 60.0, 0.5, 0}, {});
      const StepReport report = system.step(1.0 / 60);
      EXPECT_EQ(report.approximate, 1) << i;
      EXPECT_LT(report.energy.made, 1e-3) << i;
      EXPECT_GE(report.energy.external_work, 0) << i;
    }
    if (is_held) continue;
    const Energy energy = system.energy();
    EXPECT_NEAR(energy.kinetic, 3, 1e-3) << "with the hand, which has 1 kg";
    EXPECT_NEAR(energy.external_work, 3, 0.03);
  }
}

TEST(HeapTies, keep_gears_of_four_bodies_in_mesh) {
  System system = make_tied_world(true);
  std::vector<BodyId> wheels;
  std::vector<ConstraintId> axles;
  for (int i = 0; i < 2; ++i) {
    const Vec3 at{0.5 * i, 0.2, 0};
    const BodyId stand = system.bodies().create(Box{{0.4, 0.4, 0.2}}, SolidOptions{.mass = 50, .position = at});
    wheels.push_back(
        system.bodies().create(Cylinder{0.1, 0.05}, SolidOptions{.mass = 1, .position = at + Vec3{0, 0, 0.2}}));
    axles.push_back(system.joints().create(JointSpec{
        .a = wheels[static_cast<std::size_t>(i)], .b = stand, .at = at + Vec3{0, 0, 0.2}, .axis = {0, 0, 1}}));
  }
  (void)system.joints().create(
      CouplingSpec{.terms = {{.constraint = axles[0], .ratio = 1}, {.constraint = axles[1], .ratio = 2}}});
  system.bodies().set_angular_velocity(wheels[0], {0, 0, 4}),
      system.bodies().set_angular_velocity(wheels[1], {0, 0, -2});
  int swept = 0;
  for (int i = 0; i < 120; ++i) {
    swept += static_cast<int>(system.step(1.0 / 60).approximate);
    const double first = system.joints().state(axles[0]).coordinate[0],
                 second = system.joints().state(axles[1]).coordinate[0];
    EXPECT_NEAR(first + 2 * second, 0, 1e-8) << i;
  }
  EXPECT_EQ(swept, 120);
  EXPECT_GT(std::abs(system.joints().state(axles[0]).coordinate[0]), 6);
}

}  // namespace
}  // namespace iota
