// SPDX-License-Identifier: Apache-2.0
// Rays, nearest bodies and overlaps while bodies move, come and go; against the same questions about listed bodies, which
// use no tree.
#include <gtest/gtest.h>
#include <iota/system.h>

#include <cmath>
#include <random>

namespace iota {
namespace {

struct Crowd {
  System system{SystemOptions{.gravity = {}}};
  Places places = system.places();
  std::mt19937 random{11};

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 place(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

  void add(int count) {
    const Shape shapes[] = {Sphere{0.3}, Box{{0.6, 0.4, 0.2}, 0.05}, Capsule{0.1, 0.5}, Cone{0.2, 0.5}};
    for (int i = 0; i < count; ++i) {
      if (i % 2 == 0) {
        (void)system.bodies().create(shapes[i / 2 % 4], {.position = place(5), .velocity = place(2), .spin = place(3)});
        continue;
      }
      const BodyId body = system.bodies().create();
      const Vec3 at = place(5);
      for (int p = 0; p < 1 + i % 3; ++p) (void)system.particles().create(body, at + place(0.4), 1, place(2));
      if (i % 5 == 0) system.bodies().set_radius(body, number(0.01, 0.2));
    }
  }
  void compare() {
    const std::vector<BodyId> ids = system.bodies().ids();
    const std::span<const BodyId> all(ids);
    for (int question = 0; question < 60; ++question) {
      const Vec3 at = place(6), along = place(1);
      const auto met = places.ray(at, along), met_slowly = places.ray(at, along, 1e9, all);
      ASSERT_EQ(met.has_value(), met_slowly.has_value());
      if (met) {
        EXPECT_EQ(met->distance, met_slowly->distance);
      }
      const auto nearest = places.nearest(at), nearest_slowly = places.nearest(at, all);
      ASSERT_TRUE(nearest && nearest_slowly);
      EXPECT_EQ(nearest->distance, nearest_slowly->distance);
      const auto near = places.within(at, 0.7);
      EXPECT_EQ(near, places.within(at, 0.7, all));
      std::vector<BodyId> overlapped;
      overlapped = places.overlap(Sphere{0.7}, at, {});
      EXPECT_EQ(overlapped, near);
      const Quaternion turn{0.5, -0.5, 0.1, 0.7};
      EXPECT_EQ(places.overlap(Box{{2, 0.3, 1}, 0}, at, turn), places.overlap(Box{{2, 0.3, 1}, 0}, at, turn, all));
    }
  }
};

TEST(Places, of_bodies_are_found_as_by_a_look_at_each_while_they_move_come_and_go) {
  Crowd crowd;
  System& system = crowd.system;
  EXPECT_FALSE(crowd.places.nearest({}));
  EXPECT_FALSE(crowd.places.ray({}, {1, 0, 0}));
  EXPECT_TRUE(crowd.places.within({}, 1).empty());
  crowd.add(200);
  crowd.compare();
  const Snapshot start = system.snapshot();
  for (int round = 0; round < 8; ++round) {
    (void)system.step(0.05, 5);
    crowd.compare();
    if (round == 2) crowd.add(50);
    if (round == 3)
      for (const BodyId body : system.bodies().ids())
        if (body.slot % 3 == 0) system.bodies().destroy(body);
    if (round == 4)
      for (const BodyId body : system.bodies().ids()) system.bodies().set_pose(body, crowd.place(5), {0, 0, 0, 1});
    if (round == 5) system.restore(start);
    crowd.compare();
  }
}

TEST(Places, of_bodies_that_rest_are_found_after_they_are_moved_woken_or_have_other_outlines) {
  System system({.gravity = {}, .rest = {.after = 0.05}});
  Places places = system.places();
  const BodyId rod = system.bodies().create(), ball = system.bodies().create(Sphere{0.5}, {.position = {0, 5, 0}});
  (void)system.particles().create(rod, {-1, 0, 0});
  (void)system.particles().create(rod, {1, 0, 0});
  (void)system.step(0.01, 20);
  ASSERT_EQ(system.bodies().kind(ball), BodyKind::resting);
  const auto above = [&](double x) { return places.ray({x, 9, 0}, {0, -1, 0}).value_or(Hit{}); };
  EXPECT_NEAR(above(0).distance, 3.5, 1e-6);
  EXPECT_NEAR(above(0.9).point.y, system.usual_radius(), 1e-6);
  system.bodies().set_radius(rod, 0.5);
  EXPECT_NEAR(above(0.9).point.y, 0.5, 1e-6);
  system.bodies().set_velocity(ball, {1, 0, 0});
  (void)system.step(0.01, 300);
  EXPECT_EQ(above(3).body, ball);
  EXPECT_EQ(above(0).body, rod);
  system.edits().begin();
  system.bodies().destroy(ball);
  (void)system.edits().end();
  EXPECT_FALSE(above(3).body);
  system.edits().undo();
  EXPECT_EQ(above(3).body, ball);
}

TEST(Places, of_equally_near_ones_the_first_slot_is_found) {
  System system;
  Places places = system.places();
  std::vector<BodyId> balls;
  for (int i = 0; i < 40; ++i) balls.push_back(system.bodies().create(Sphere{0.5}, {.position = {0, 0, 5}}));
  EXPECT_EQ(places.nearest({})->body, balls.front());
  EXPECT_EQ(places.ray({}, {0, 0, 1})->body, balls.front());
  system.bodies().destroy(balls.front());
  EXPECT_EQ(places.nearest({})->body, balls[1]);
}

TEST(Places, follow_an_edit_between_two_questions) {
  System system;
  Places places = system.places();
  const BodyId body = system.bodies().create(Sphere{0.5});
  EXPECT_NEAR(places.ray({-5, 0, 0}, {2, 0, 0})->distance, 4.5, 1e-6);
  system.bodies().set_pose(body, {1, 0, 0}, {0, 0, 0, 1});
  EXPECT_NEAR(places.ray({-5, 0, 0}, {2, 0, 0})->distance, 5.5, 1e-6);
  system.bodies().set_kind(body, BodyKind::inactive);
  EXPECT_FALSE(places.ray({-5, 0, 0}, {1, 0, 0}));
}

TEST(Places, know_a_half_space_from_everywhere_and_a_mesh_by_its_triangles) {
  System system;
  const BodyId ground = system.bodies().create(HalfSpace{{0, 1, 0}}, {.kind = BodyKind::static_});
  const Mesh cube = convex_hull(std::vector<Vec3>{
      {-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}});
  const BodyId block = system.bodies().create(cube, {.position = {0, 3, 0}, .kind = BodyKind::static_});
  Places places = system.places();
  const auto under = places.ray({1e6, 50, 0}, {0, -1, 0});
  ASSERT_TRUE(under);
  EXPECT_EQ(under->body, ground);
  EXPECT_NEAR(under->distance, 50, 1e-3);
  const auto on = places.ray({0.5, 50, 0.2}, {0, -1, 0});
  ASSERT_TRUE(on);
  EXPECT_EQ(on->body, block);
  EXPECT_NEAR(on->distance, 46, 1e-9);
  const auto inside = places.nearest({0, 3.9, 0});
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->body, block);
  EXPECT_NEAR(inside->distance, -0.1, 1e-9);
  EXPECT_NEAR(inside->point.y, 4, 1e-9);
  EXPECT_EQ(places.within({0, 1, 0}, 1.001).size(), 2u);
}

TEST(Places, have_the_holes_of_concave_shapes_and_both_sides_of_the_ground) {
  System system;
  const BodyId ring = system.bodies().create(Torus{1, 0.2}, {.position = {0, 5, 0}});
  (void)system.bodies().create(HalfSpace{{0, 1, 0}}, {.kind = BodyKind::static_});
  Places places = system.places();
  const auto count = [&](const Shape& shape, const Vec3& at) { return places.overlap(shape, at, {}).size(); };
  EXPECT_EQ(count(Sphere{0.7}, {0, 5, 0}), 0u) << "it is in the hole";
  EXPECT_EQ(count(Sphere{0.81}, {0, 5, 0}), 1u);
  EXPECT_EQ(count(Box{{0.1, 0.1, 0.1}, 0}, {1, 5, 0}), 1u) << "it is in the wire";
  EXPECT_EQ(count(Box{{0.1, 0.1, 3}, 0}, {0, 5, 0}), 0u) << "it goes through the hole";
  EXPECT_EQ(places.overlap(Box{{3, 0.1, 0.1}, 0}, {0, 5, 0}, {}), std::vector{ring});
  EXPECT_EQ(count(Box{{1, 1, 1}, 0}, {7, 0.51, 0}), 0u);
  EXPECT_EQ(count(Box{{1, 1, 1}, 0}, {7, 0.49, 0}), 1u);
  EXPECT_EQ(count(Box{{1, 1, 1}, 0}, {7, -3, 0}), 1u) << "it is below the ground";
}

TEST(Places, of_a_wall_that_is_an_open_mesh_are_on_both_of_its_sides_and_never_inside) {
  System system;
  Places places = system.places();
  const Mesh wall{{{0, 0, -1}, {0, 0, 1}, {0, 2, 1}, {0, 2, -1}}, {{0, 1, 2}, {0, 2, 3}}};
  const BodyId at = system.bodies().create_obstacle(wall, {3, 0, 0});
  for (const double side : {-1.0, 1.0}) {
    const auto met = places.ray({3 + side, 0.7, 0.2}, {-side, 0, 0});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->body, at);
    EXPECT_NEAR(met->distance, 1, 1e-9);
    EXPECT_NEAR(places.nearest({3 + 0.1 * side, 1, 0})->distance, 0.1, 1e-9);
  }
  EXPECT_EQ(places.overlap(Box{{0.1, 0.1, 0.1}, 0}, {3.04, 1, 0}, {}), std::vector{at});
  EXPECT_TRUE(places.overlap(Box{{0.1, 0.1, 0.1}, 0}, {3.06, 1, 0}, {}).empty());

  System restored;
  restored.restore(system.snapshot());
  EXPECT_NEAR(restored.places().nearest({3.1, 1, 0})->distance, 0.1, 1e-9);
  system.bodies().destroy(at);
  EXPECT_FALSE(places.nearest({3.1, 1, 0}));
}

TEST(Places, refuse_places_directions_and_radii_that_are_none) {
  System system;
  const BodyId gone = system.bodies().create(Sphere{0.5});
  Places places = system.places();
  const double nan = std::nan("");
  EXPECT_THROW((void)places.ray({}, {}), std::invalid_argument);
  EXPECT_THROW((void)places.ray({nan, 0, 0}, {1, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)places.nearest({0, nan, 0}), std::invalid_argument);
  EXPECT_THROW((void)places.within({}, -1), std::invalid_argument);
  EXPECT_THROW((void)places.within({}, nan), std::invalid_argument);
  for (const Shape& shape : {Shape(Torus{1, 0.2}), Shape(HalfSpace{{0, 1, 0}}), Shape(Sphere{nan}), Shape(Mesh{})})
    EXPECT_THROW((void)places.overlap(shape, {}, {}), std::invalid_argument);
  EXPECT_THROW((void)places.overlap(Sphere{1}, {nan, 0, 0}, {}), std::invalid_argument);
  system.bodies().destroy(gone);
  EXPECT_THROW((void)places.nearest({}, std::span(&gone, 1)), StaleIdError);
  EXPECT_FALSE(places.nearest({}, std::span<const BodyId>{}));
}

}  // namespace
}  // namespace iota
