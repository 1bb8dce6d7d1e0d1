// SPDX-License-Identifier: Apache-2.0
// Bodies that hardly move keep their contacts: whatever changes beside that is noticed. Judged from places.
#include "step/contacts.h"

#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace iota {
namespace {

constexpr double standing_step = 1.0 / 60;

struct StandingBox {
  System system{{.gravity = {0, -9.81, 0}}};
  BodyId table, box;

  explicit StandingBox(double friction = 0.5, const Vec3& velocity = {}) {
    system.set_usual_material(Material{friction});
    table = system.bodies().create_obstacle(Box{{4, 0.2, 4}}, {0, -0.1, 0}, {});
    system.bodies().set_material(table, Material{friction});
    box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}, .velocity = velocity});
  }
  Vec3 place() const { return system.bodies().center_of_mass(box); }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) EXPECT_EQ(system.step(standing_step).unconverged, 0);
  }
};

TEST(StandingContacts, go_along_with_a_body_that_creeps_over_an_edge) {
  StandingBox scene(0);
  scene.system.bodies().set_pose(scene.box, {2 - 6e-5, 0.1, 0}, {});
  scene.system.bodies().set_velocity(scene.box, {0.2 * 3e-6 / standing_step, 0, 0});  // a part of what is looked over
  scene.run(90);
  EXPECT_NEAR(scene.place().x, 2 - 6e-6, 1e-9);
  EXPECT_NEAR(scene.place().y, 0.1, 1e-9);
  scene.run(240);  // the corners on the table stay at its edge
  EXPECT_LT(scene.place().y, 0);
}

TEST(StandingContacts, end_where_the_table_is_moved_away_or_a_body_is_moved) {
  StandingBox scene;
  scene.run(60);
  scene.system.bodies().set_pose(scene.table, {0, -0.15, 0}, {});
  scene.run(60);
  EXPECT_NEAR(scene.place().y, 0.05, 1e-6);
  scene.system.bodies().set_pose(scene.table, {9, -0.15, 0}, {});
  scene.run(30);
  EXPECT_LT(scene.place().y, -0.5);
}

TEST(StandingContacts, end_where_a_static_body_of_particles_is_moved) {
  System system({.gravity = {0, -9.81, 0}});
  system.set_usual_material(Material{0.5});
  const BodyId below = system.bodies().create(Box{{1, 0.2, 1}}, {.position = {0, -0.1, 0}});
  system.bodies().set_kind(below, BodyKind::static_);
  const BodyId box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
  for (int i = 0; i < 60; ++i) (void)system.step(standing_step);
  system.bodies().set_pose(below, {0, -0.15, 0}, {});
  for (int i = 0; i < 60; ++i) (void)system.step(standing_step);
  EXPECT_NEAR(system.bodies().center_of_mass(box).y, 0.05, 1e-5);
}

TEST(StandingContacts, see_another_friction) {
  StandingBox scene;
  scene.system.set_gravity({2, -9.81, 0});
  scene.run(60);
  EXPECT_NEAR(scene.place().x, 0, 1e-4);
  for (const BodyId body : {scene.table, scene.box}) scene.system.bodies().set_material(body, Material{0});
  scene.run(60);
  EXPECT_NEAR(scene.place().x, 1, 0.05);  // g_x t^2/2
}

TEST(StandingContacts, of_a_ball_see_its_radius) {
  System system({.gravity = {0, -9.81, 0}});
  system.set_usual_material(Material{0.5});
  const BodyId ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
  system.bodies().set_material(ground, Material{0.5});
  const BodyId ball = system.bodies().create(Sphere{0.1}, {.position = {0, 0.1, 0}});
  const BodyId point = system.bodies().create();
  const ParticleId particle = system.particles().create(point, {1, 0.05, 0});
  system.bodies().set_radius(point, 0.05), system.bodies().set_material(point, Material{0.5});
  for (int i = 0; i < 60; ++i) (void)system.step(standing_step);
  EXPECT_NEAR(system.particles().position(particle).y, 0.05, 1e-6);
  system.bodies().set_radius(point, 0.08);
  for (int i = 0; i < 120; ++i) (void)system.step(standing_step);
  EXPECT_NEAR(system.particles().position(particle).y, 0.08, 1e-4);
  EXPECT_NEAR(system.bodies().center_of_mass(ball).y, 0.1, 1e-6);
}

TEST(StandingContacts, of_a_restored_tower_go_on_alike) {
  System system({.gravity = {0, -9.81, 0}});
  system.set_usual_material(Material{0.5});
  const BodyId ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
  system.bodies().set_material(ground, Material{0.5});
  std::vector<BodyId> tower;
  for (int i = 0; i < 5; ++i)
    tower.push_back(system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0.01 * (i % 2), 0.1 + 0.2 * i, 0}}));
  for (int i = 0; i < 40; ++i) (void)system.step(standing_step);
  const Snapshot snapshot = system.snapshot();
  const auto go_on = [&] {
    std::vector<Vec3> places;
    system.bodies().set_velocity(tower[2], {2e-5, 0, 1e-5});
    for (int i = 0; i < 60; ++i) (void)system.step(standing_step);
    for (const BodyId body : tower) places.push_back(system.bodies().center_of_mass(body));
    return places;
  };
  const std::vector<Vec3> first = go_on();
  system.restore(snapshot);
  EXPECT_EQ(go_on(), first);
}

/// Bodies that sweeps have solved keep their contacts for a longer way.
void sweep_all(System& system) { system.set_budget({.contacts = 1}); }

TEST(StandingContacts, of_sweeps_go_along_with_a_body_that_creeps_over_an_edge) {
  StandingBox scene(0);
  sweep_all(scene.system);
  scene.system.bodies().set_pose(scene.box, {2 - 3e-3, 0.1, 0}, {});
  scene.system.bodies().set_velocity(scene.box, {3e-3, 0, 0});
  int approximate = 0;
  for (int i = 0; i < 50; ++i) approximate += scene.system.step(standing_step).approximate;
  EXPECT_GT(approximate, 25);
  EXPECT_NEAR(scene.place().x, 2 - 0.5e-3, 1e-4);
  EXPECT_NEAR(scene.place().y, 0.1, 1e-3);
  scene.run(300);  // its middle is 14 mm beyond the edge
  EXPECT_LT(scene.place().y, 0.05);
}

TEST(StandingContacts, of_a_restored_heap_go_on_alike) {
  System system({.gravity = {0, -9.81, 0}});
  sweep_all(system);
  system.set_usual_material(Material{0.5});
  const BodyId ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
  system.bodies().set_material(ground, Material{0.5});
  std::vector<BodyId> heap;
  for (int i = 0; i < 8; ++i) {
    const Vec3 place{0.08 * (i % 3), 0.1 + 0.2 * i, 0.05 * (i % 2)};
    heap.push_back(i % 2 ? system.bodies().create(Sphere{0.09}, {.position = place})
                         : system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = place}));
  }
  for (int i = 0; i < 100; ++i) (void)system.step(standing_step);
  const Snapshot snapshot = system.snapshot();
  const auto go_on = [&] {
    std::vector<Vec3> places;
    for (int i = 0; i < 60; ++i) (void)system.step(standing_step);
    for (const BodyId body : heap) places.push_back(system.bodies().center_of_mass(body));
    return places;
  };
  const std::vector<Vec3> first = go_on();
  system.restore(snapshot);
  EXPECT_EQ(go_on(), first);
}

}  // namespace
}  // namespace iota
