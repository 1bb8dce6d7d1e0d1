// SPDX-License-Identifier: Apache-2.0
// Bodies that rest, slide and roll on obstacles, judged from places and velocities.
#include "step/contacts.h"

#include "base/text.h"
#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace iota {
namespace {

BodyId make_ground(System& system, double friction, const Vec3& normal = {0, 1, 0}) {
  const BodyId body = system.bodies().create_obstacle(HalfSpace{normal}, {}, {});
  system.bodies().set_material(body, Material{friction});
  return body;
}
BodyId make_solid(System& system, const Shape& shape, const SolidOptions& options, double friction = 0.5) {
  const BodyId body = system.bodies().create(shape, options);
  system.bodies().set_material(body, Material{friction});
  return body;
}
void run_for(System& system, double seconds, double h) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / h)); ++i) {
    const StepReport report = system.step(h);
    ASSERT_EQ(report.unconverged, 0) << "step " << i;
  }
}

TEST(Contacts, of_bodies_without_a_material_are_none) {
  System system;
  (void)make_ground(system, 0.5);
  const BodyId box = system.bodies().create(Box{{1, 1, 1}}, {.position = {0, 0.5, 0}});
  run_for(system, 0.5, 1.0 / 60);
  EXPECT_NEAR(system.bodies().center_of_mass(box).y, 0.5 - g * 0.25 / 2, 1e-9);
}

TEST(Contacts, let_a_box_rest_where_it_lies) {
  for (const double size : {0.01, 1.0, 30.0})
    for (const double h : {1.0 / 240, 1.0 / 60}) {
      SCOPED_TRACE(size);
      System system;
      (void)make_ground(system, 0.5);
      const BodyId box = make_solid(system, Box{{size, size, size}}, {.position = {0, size / 2, 0}});
      run_for(system, 3, h);
      EXPECT_LT(norm(system.bodies().center_of_mass(box) - Vec3{0, size / 2, 0}), 1e-7 * size);
    }
}

TEST(Contacts, are_the_same_far_from_the_origin) {
  for (const double far : {1e5, 1e7}) {
    SCOPED_TRACE(far);
    const Vec3 at{far, far, far};
    System system;
    const BodyId below = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, at, {});
    system.bodies().set_material(below, Material{0.5});
    const BodyId box =
        make_solid(system, Box{{0.4, 0.2, 0.4}}, {.position = at + Vec3{0, 0.1, 0}, .velocity = {1, 0, 0}});
    const BodyId ball =
        make_solid(system, Sphere{0.1}, {.position = at + Vec3{2, 0.1, 0}, .velocity = {1, 0, 0}, .spin = {0, 0, -10}});
    run_for(system, 1, 1.0 / 120);
    EXPECT_LT(norm(system.bodies().center_of_mass(box) - at - Vec3{1 / g, 0.1, 0}), 1e-4);
    EXPECT_LT(norm(system.bodies().center_of_mass(ball) - at - Vec3{3, 0.1, 0}), 1e-6);
  }
}

/// A short step stores less of the strain that a blow has left in a long one, and a contact that ends stores nothing.
TEST(Contacts, have_the_strain_that_is_left_of_a_blow_in_the_account_of_energy) {
  System system;
  (void)make_ground(system, 0.8);
  for (int i = 0; i < 4; ++i)
    (void)make_solid(system, Box{{0.3, 0.2, 0.4}},
                     {.position = {0.1 * i, 0.4 + 0.5 * i, 0}, .velocity = {3, -4, 1}, .spin = {1, 30, 8}}, 0.8);
  for (int i = 0; i < 120; ++i) {
    const Energy energy = system.step(i % 3 == 0 ? 1.0 / 60 : 1.0 / 600).energy;
    EXPECT_LT(std::abs(energy.balance()), 2e-4 * energy.edits) << i;  // it was 2e-2
  }
}

TEST(Contacts, are_the_same_among_a_hundred_obstacles_that_are_not_in_reach) {
  std::vector<std::vector<Vec3>> ways;
  for (const int others : {0, 100}) {
    System system;
    std::vector<BodyId> boxes;
    for (int i = 0; i < 3; ++i)
      boxes.push_back(make_solid(system, Box{{0.2, 0.2, 0.2}}, {.position = {0.1 * i, 0.5 + 0.3 * i, 0}}));
    (void)make_ground(system, 0.5);
    for (int i = 0; i < 8; ++i)  // steps of stairs
      system.bodies().set_material(
          system.bodies().create_obstacle(Box{{0.2, 0.05, 1}}, {-0.4 + 0.2 * i, 0.05 * (i % 3), 0}, {}), Material{0.3});
    for (int i = 0; i < others; ++i)
      system.bodies().set_material(
          system.bodies().create_obstacle(Box{{0.2, 0.2, 0.2}}, {5 + 0.3 * (i % 10), 0.1, 0.3 * (i / 10)}, {}),
          Material{0.3});
    ways.emplace_back();
    for (int step = 0; step < 120; ++step) {
      (void)system.step(1.0 / 120);
      for (const BodyId box : boxes) ways.back().push_back(system.bodies().center_of_mass(box));
    }
  }
  EXPECT_EQ(ways[0], ways[1]);
}

TEST(Contacts, stop_a_sliding_box_after_the_way_that_friction_says) {
  for (const double friction : {0.1, 0.4, 0.8}) {
    System system;
    (void)make_ground(system, friction);
    const BodyId box =
        make_solid(system, Box{{0.4, 0.1, 0.4}}, {.position = {0, 0.05, 0}, .velocity = {2, 0, 1}}, friction);
    run_for(system, 3, 1.0 / 240);
    EXPECT_NEAR(norm(system.bodies().center_of_mass(box) - Vec3{0, 0.05, 0}), 5 / (2 * friction * g), 2e-2);
    EXPECT_LT(norm(system.bodies().velocity(box)), 1e-6);
  }
}

TEST(Contacts, let_balls_and_cylinders_roll_at_a_constant_speed) {
  const Quaternion along_z{0, std::numbers::sqrt2 / 2, 0, std::numbers::sqrt2 / 2};
  for (const double h : {1.0 / 60, 1.0 / 120, 1.0 / 240})
    for (const double r : {0.02, 0.1, 0.5})
      for (const bool is_ball : {true, false}) {
        SCOPED_TRACE(std::to_string(h) + " " + std::to_string(r) + (is_ball ? " ball" : " cylinder"));
        System system;
        (void)make_ground(system, 0.5);
        const double speed = std::min(1.0, 0.6 * r / h);
        const BodyId body = make_solid(
            system, is_ball ? Shape{Sphere{r}} : Shape{Cylinder{r, 2 * r}},
            {.position = {0, r, 0}, .orientation = along_z, .velocity = {speed, 0, 0}, .spin = {0, 0, -speed / r}});
        run_for(system, 3, h);
        EXPECT_NEAR(system.bodies().velocity(body).x, speed, 1e-3 * speed);
        EXPECT_NEAR(system.bodies().center_of_mass(body).y, r, 2e-3 * r);
        EXPECT_NEAR(system.bodies().center_of_mass(body).x, 3 * speed, 1e-2 * speed);
      }
}

TEST(Contacts, make_a_sliding_ball_roll_at_five_sevenths_of_its_speed) {
  System system;
  (void)make_ground(system, 0.3);
  const BodyId ball = make_solid(system, Sphere{0.1}, {.position = {0, 0.1, 0}, .velocity = {2, 0, 0}}, 0.3);
  run_for(system, 2, 1.0 / 240);
  EXPECT_NEAR(system.bodies().velocity(ball).x, 2 * 5.0 / 7, 5e-3);
}

TEST(Contacts, hold_a_box_on_a_slope_below_the_angle_of_friction_and_not_above) {
  for (const double degrees : {10.0, 26.0, 27.0, 35.0}) {
    SCOPED_TRACE(degrees);
    const double a = degrees * std::numbers::pi / 180;
    System system;
    (void)make_ground(system, 0.5, {std::sin(a), std::cos(a), 0});
    const Quaternion turn{0, 0, -std::sin(a / 2), std::cos(a / 2)};
    const BodyId box = make_solid(system, Box{{0.4, 0.1, 0.4}},
                                  {.position = {0.05 * std::sin(a), 0.05 * std::cos(a), 0}, .orientation = turn});
    const Vec3 start = system.bodies().center_of_mass(box);
    run_for(system, 2, 1.0 / 120);
    const double way = norm(system.bodies().center_of_mass(box) - start);
    const double expected = std::max(0.0, 0.5 * g * (std::sin(a) - 0.5 * std::cos(a)) * 4);
    EXPECT_NEAR(way, expected, 2e-3) << "it slips a little later, by the strain of what sticks";
  }
}

TEST(Contacts, of_the_usual_material_are_of_all_bodies_that_have_none_of_their_own) {
  System system;
  const BodyId table = system.bodies().create_obstacle(Box{{4, 0.2, 4}}, {0, 1, 0}, {});
  (void)system.bodies().create(Box{{4, 0.2, 4}}, {.position = {0, -0.1, 0}, .kind = BodyKind::static_});
  system.set_usual_material(Material{0.6});
  const BodyId box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 1.5, 0}});
  run_for(system, 1, 1.0 / 120);
  EXPECT_NEAR(system.bodies().center_of_mass(box).y, 1.2, 1e-6);
  system.bodies().set_material(table, Material{.touches = Touches::nothing});
  run_for(system, 2, 1.0 / 120);
  EXPECT_NEAR(system.bodies().center_of_mass(box).y, 0.1, 1e-6);
  system.set_usual_material(std::nullopt);
  run_for(system, 0.5, 1.0 / 120);
  EXPECT_LT(system.bodies().center_of_mass(box).y, -0.5);
}

TEST(Contacts, are_not_with_what_a_nail_or_a_joint_of_the_world_holds_a_body_within) {
  for (const bool is_nailed : {true, false}) {
    System system;
    system.set_usual_material(Material{0.6});
    (void)system.bodies().create_obstacle(Box{{0.2, 0.2, 0.2}}, {}, {});
    (void)system.bodies().create_obstacle(Box{{0.1, 4, 4}}, {-0.45, 0, 0}, {});
    const BodyId rod =
        system.bodies().create(Box{{1, 0.1, 0.1}}, {.position = {0.5, 0, 0}, .attachments = {{-0.5, 0, 0}}});
    if (is_nailed)
      system.particles().nail(system.bodies().attachments(rod)[0]);
    else
      (void)system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = rod, .axis = {0, 0, 1}});
    const double before = system.energy().kinetic + system.energy().potential;
    run_for(system, 0.4, 1.0 / 240);
    EXPECT_NEAR(system.energy().kinetic + system.energy().potential, before, 1e-3 * 1000 * 0.01 * g)
        << "it swings through the beam that it hangs from";
    run_for(system, 0.4, 1.0 / 240);
    EXPECT_GT(system.bodies().center_of_mass(rod).x, -0.25) << "but not through the wall";
  }
}

TEST(Contacts, carry_the_weight_at_the_places_that_are_told) {
  System system;
  const BodyId below = make_ground(system, 0.5);
  const BodyId box = make_solid(system, Box{{0.4, 0.2, 0.3}}, {.mass = 3, .position = {0.5, 0.1, 0}});
  run_for(system, 0.5, 1.0 / 120);
  const std::vector<ContactPoint> points = system.bodies().contacts(box);
  ASSERT_EQ(points.size(), 4u);
  Vec3 sum;
  for (const ContactPoint& point : points) {
    EXPECT_EQ(point.other, below);
    EXPECT_NEAR(point.position.y, 0, 1e-9);
    EXPECT_NEAR(std::abs(point.position.x - 0.5), 0.2, 1e-6);
    sum += point.force;
  }
  EXPECT_LT(norm(sum - Vec3{0, 3 * g, 0}), 1e-6);
}

TEST(Contacts, carry_the_weight_alone_where_a_hinge_holds_the_corner_that_lies) {
  System system;
  system.set_usual_material(Material{});
  (void)system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
  Bodies bodies = system.bodies();
  const BodyId box = bodies.create(Box{{0.2, 0.1, 0.2}}, {.mass = 1, .position = {0, 0.05, 0}});
  for (int i = 0; i < 60; ++i) (void)system.step(0.01);
  const BodyId holder = bodies.create();
  const ParticleId corner = bodies.create_attachment(box, {0.099, 0, 0.099});
  (void)system.edits().combine(corner, system.particles().create(holder, {0.099, 0, 0.099}, 0.01));
  for (int i = 0; i < 60; ++i) (void)system.step(0.01);
  bodies.set_kind(holder, BodyKind::scripted);
  for (int i = 0; i < 60; ++i) (void)system.step(0.01);
  double weight = 0;
  for (const ContactPoint& contact : bodies.contacts(box)) weight += contact.force.y;
  EXPECT_GT(weight, 1);
  EXPECT_LT(weight, 20) << "its weight is 9.8 N, of which the hinge may carry a part";
}

TEST(Contacts, tell_the_hardest_impact_of_a_step_once) {
  System system;
  (void)make_ground(system, 0.5);
  (void)make_solid(system, Sphere{0.1}, {.position = {2, 0.6, 0}});
  int impacts = 0;
  for (int i = 0; i < 240; ++i) {
    const StepReport report = system.step(1.0 / 120);
    if (!(report.impact.speed > 0.5)) continue;
    ++impacts;
    EXPECT_NEAR(report.impact.speed, std::sqrt(2 * g * 0.5), 0.1);
    EXPECT_NEAR(report.impact.position.x, 2, 1e-9);
    EXPECT_NEAR(report.impact.position.y, 0, 1e-6);
  }
  EXPECT_EQ(impacts, 1);
}

TEST(Contacts, leave_alone_what_begins_deep_in_an_obstacle_and_ease_out_what_has_its_middle_outside) {
  for (const bool is_plane : {true, false}) {
    System system;
    if (is_plane)
      (void)make_ground(system, 0.5);
    else
      system.bodies().set_material(system.bodies().create_obstacle(Box{{20, 2, 5}}, {0, -1, 0}, {}), Material{0.5});
    const BodyId deep = make_solid(system, Box{{0.2, 0.2, 0.2}}, {.position = {0, -1, 0}});
    std::vector<BodyId> eased;
    for (const double height : {0.095, 0.06, 0.02})
      for (const Shape& shape :
           std::vector<Shape>{Box{{0.2, 0.2, 0.2}}, Sphere{0.1}, Cylinder{0.1, 0.3}, Capsule{0.1, 0.2}})
        eased.push_back(
            make_solid(system, shape, {.position = {1 + 0.5 * static_cast<double>(eased.size()), height, 0}}));
    double fastest = 0;
    std::vector<std::string> warnings;
    for (int i = 0; i < 240; ++i) {
      const StepReport report = system.step(1.0 / 120);
      warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
      for (const BodyId body : eased) fastest = std::max(fastest, norm(system.bodies().velocity(body)));
    }
    EXPECT_LT(system.bodies().center_of_mass(deep).y, -10);
    for (const BodyId body : eased) EXPECT_NEAR(system.bodies().center_of_mass(body).y, 0.1, 1e-5);
    EXPECT_LT(fastest, 0.05);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(text("body ", deep.slot, " is ")), std::string::npos) << warnings[0];
  }
}

TEST(Contacts, hold_chains_and_tables_that_fall_on_the_ground) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system;
    system.set_mode(mode);
    (void)make_ground(system, 0.6);
    system.set_usual_material(Material{0.6});
    std::vector<BodyId> links;
    ParticleId last{};
    for (int i = 0; i < 30; ++i) {
      const BodyId body = system.bodies().create();
      const Vec3 a{0.1 * i, 0.5 + 0.02 * i, 0.01 * i}, b = a + Vec3{0.1, 0.02, 0.01};
      const ParticleId p = system.particles().create(body, a, 0.05), q = system.particles().create(body, b, 0.05);
      system.bodies().set_radius(body, 0.02);
      if (i > 0) (void)system.edits().combine(last, p);
      last = q, links.push_back(body);
    }
    const BodyId top = system.bodies().create(Box{{1, 0.05, 0.6}}, {.mass = 10, .position = {0, 0.725, 3}});
    for (const double x : {-0.45, 0.45})
      for (const double z : {2.75, 3.25}) {
        const BodyId leg = system.bodies().create(Box{{0.05, 0.6, 0.05}}, {.mass = 0.01, .position = {x, 0.4, z}});
        (void)system.joints().create(JointSpec{.kind = ConstraintKind::weld, .a = top, .b = leg, .at = {x, 0.7, z}});
      }
    run_for(system, 5, 1.0 / 60);
    for (const BodyId link : links) {
      EXPECT_NEAR(system.bodies().center_of_mass(link).y, 0.02, 1e-8);
      EXPECT_LT(norm(system.bodies().velocity(link)), 1e-8);
    }
    EXPECT_NEAR(system.bodies().center_of_mass(top).y, 0.625, 1e-7);
  }
}

TEST(Contacts, of_bodies_without_an_outline_are_none) {
  System system;
  const BodyId empty = system.bodies().create({.kind = BodyKind::static_}), moving = system.bodies().create();
  for (const BodyId body : {empty, moving}) system.bodies().set_material(body, Material{});
  (void)make_solid(system, Sphere{0.1}, {.position = {0, 1, 0}});
  run_for(system, 0.1, 1.0 / 60);
}

TEST(Contacts, are_the_same_after_a_snapshot_in_another_system) {
  System system;
  (void)make_ground(system, 0.5);
  const BodyId box =
      make_solid(system, Box{{0.3, 0.2, 0.4}}, {.position = {0, 0.5, 0}, .velocity = {1, 0, 0}, .spin = {1, 2, 3}});
  run_for(system, 0.5, 1.0 / 120);
  const Snapshot saved = system.snapshot();
  run_for(system, 0.5, 1.0 / 120);
  const Vec3 there = system.bodies().center_of_mass(box);
  System other;
  other.restore(saved);
  run_for(other, 0.5, 1.0 / 120);
  EXPECT_EQ(other.bodies().center_of_mass(box), there);
}

}  // namespace
}  // namespace iota
