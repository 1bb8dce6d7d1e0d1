// SPDX-License-Identifier: Apache-2.0
// Forces, gaps and slips of contacts, by closed forms.
#include "ingredient/contact_readings.h"

#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace iota {
namespace {

struct OnGround {
  System system;
  BodyId ground;
  explicit OnGround(double friction) {
    ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
    system.bodies().set_material(ground, Material{friction}), system.set_usual_material(Material{friction});
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) (void)system.step(1.0 / 120);
  }
};

TEST(ContactReadings, tell_friction_and_slip_of_a_box_that_slides_and_then_sticks) {
  for (const double size : {0.02, 2.0}) {
    OnGround scene(0.4);
    System& system = scene.system;
    const double speed = 4 * std::sqrt(size);
    const BodyId box =
        system.bodies().create(Box{{size, size / 4, size}}, {.position = {0, size / 8, 0}, .velocity = {speed, 0, 0}});
    scene.run(6);
    const double weight = system.bodies().mass(box) * g;
    Vec3 sum;
    for (const ContactPoint& point : system.contacts().points()) {
      EXPECT_TRUE(point.slides && point.body == box && point.other == scene.ground);
      EXPECT_NEAR(point.slip, system.bodies().velocity(box).x, 1e-6 * speed);
      EXPECT_LT(std::abs(point.gap), 1e-6 * size);
      EXPECT_NEAR(norm(point.friction()), 0.4 * dot(point.force, point.normal), 1e-6 * weight);
      sum += point.force;
    }
    EXPECT_LT(norm(sum - Vec3{-0.4 * weight, weight, 0}), 1e-3 * weight);
    EXPECT_LT(norm(system.contacts().force(box, scene.ground) - sum), 1e-9 * weight);
    EXPECT_LT(norm(system.contacts().force(scene.ground, box) + sum), 1e-9 * weight);
    scene.run(400);
    ASSERT_FALSE(system.contacts().points().empty());
    for (const ContactPoint& point : system.contacts().points()) {
      EXPECT_FALSE(point.slides);
      EXPECT_LT(point.slip, 1e-6 * speed);
    }
  }
}

TEST(ContactReadings, tell_no_slip_of_a_ball_that_rolls) {
  OnGround scene(0.5);
  const BodyId ball =
      scene.system.bodies().create(Sphere{0.1}, {.position = {0, 0.1, 0}, .velocity = {1, 0, 0}, .spin = {0, 0, -10}});
  scene.run(60);
  const std::vector<ContactPoint> points = scene.system.contacts().points();
  ASSERT_EQ(points.size(), 1u);
  EXPECT_LT(points[0].slip, 1e-3);
  EXPECT_FALSE(points[0].slides);
  EXPECT_NEAR(points[0].force.y, scene.system.bodies().mass(ball) * g, 1e-3 * points[0].force.y);
}

TEST(ContactReadings, list_pairs_in_order_with_what_moves_first) {
  OnGround scene(0.5);
  std::vector<BodyId> tower;
  for (int i = 0; i < 3; ++i)
    tower.push_back(scene.system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1 + 0.2 * (2 - i), 0}}));
  scene.run(10);
  const std::vector<ContactPoint> points = scene.system.contacts().points();
  std::vector<std::pair<BodyId, BodyId>> pairs;
  for (const ContactPoint& point : points) {
    if (pairs.empty() || pairs.back() != std::pair{point.body, point.other})
      pairs.emplace_back(point.body, point.other);
    const Vec3 away = scene.system.bodies().center_of_mass(point.body) - point.position;
    EXPECT_GT(dot(away, point.normal), 0) << "towards the body";
  }
  EXPECT_EQ(pairs, (std::vector<std::pair<BodyId, BodyId>>{
                       {tower[0], tower[1]}, {tower[1], tower[2]}, {tower[2], scene.ground}}));
  const double weight = scene.system.bodies().mass(tower[0]) * g;
  EXPECT_NEAR(scene.system.contacts().force(tower[1], tower[0]).y, -weight, 1e-6 * weight);
  EXPECT_NEAR(scene.system.contacts().force(tower[2], scene.ground).y, 3 * weight, 1e-6 * weight);
  EXPECT_EQ(norm(scene.system.contacts().force(tower[0], scene.ground)), 0);
}

}  // namespace
}  // namespace iota
