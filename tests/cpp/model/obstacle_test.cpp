// SPDX-License-Identifier: Apache-2.0
// Static bodies without particles: what finds them, what they are saved with, and what takes no notice of them.
#include <gtest/gtest.h>
#include <iota/system.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace iota {
namespace {

Mesh fan(double size) { return {{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}}, {{0, 1, 2}, {0, 2, 3}}}; }

/// A chain of rods that falls, with or without a furnished room around it.
std::uint64_t fallen(bool has_room) {
  System system;
  ParticleId above = system.particles().create(system.bodies().create(), {0, 0, 0});
  for (int i = 0; i < 6; ++i) {
    const BodyId rod = system.bodies().create();
    const ParticleId top = system.particles().create(rod, {0.3 * i, 0, 0});
    const ParticleId end = system.particles().create(rod, {0.3 * (i + 1), 0, 0});
    (void)system.edits().combine(above, top);
    above = end;
  }
  if (has_room) {
    (void)system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {0, -1, 0});
    (void)system.bodies().create_obstacle(fan(40), {-100, 0, 0});
  }
  for (int i = 0; i < 60; ++i) (void)system.step(0.01);
  std::uint64_t bits = 0;
  for (const ParticleId p : system.particles().ids()) {
    const Vec3 at = system.particles().position(p);
    for (const double x : {at.x, at.y, at.z, system.bodies().radius(system.particles().body(p))})
      bits = bits * 31 + std::bit_cast<std::uint64_t>(x);
  }
  return bits;
}

TEST(Obstacles, change_no_bit_of_the_motion_or_of_the_usual_radius) { EXPECT_EQ(fallen(true), fallen(false)); }

TEST(Obstacles, are_saved_undone_and_destroyed_with_their_meshes) {
  System system;
  const BodyId room = system.bodies().create_obstacle(fan(2), {1, 0, 0}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)});
  const BodyId ball = system.bodies().create(Sphere{0.1}, {.position = {0, 5, 0}});
  EXPECT_EQ(system.bodies().ids(), std::vector{ball});
  EXPECT_EQ(system.bodies().obstacles(), std::vector{room});
  EXPECT_EQ(system.bodies().articulate_count(), 1u);
  System other;
  other.restore(system.snapshot());
  EXPECT_TRUE(other.validate().empty());
  ASSERT_EQ(other.bodies().solids(room).size(), 1u);
  EXPECT_EQ(std::get<Mesh>(other.bodies().solids(room)[0].shape), fan(2));
  EXPECT_EQ(other.bodies().solids(room)[0].position, (Vec3{1, 0, 0}));
  EXPECT_EQ(other.snapshot().bytes, system.snapshot().bytes);
  system.edits().begin();
  system.bodies().destroy(room);
  (void)system.edits().end();
  EXPECT_TRUE(system.bodies().obstacles().empty());
  EXPECT_TRUE(system.validate().empty());
  system.edits().undo();
  EXPECT_EQ(system.bodies().obstacles(), std::vector{room});
}

TEST(Obstacles, reach_viewers_as_static_bodies_and_move_with_set_pose) {
  System system;
  const BodyId wall = system.bodies().create_obstacle(Box{{1, 2, 0.1}}, {0, 1, 0});
  const SceneChanges first = system.viewer().take_scene_changes(true);
  ASSERT_EQ(first.bodies.set.size(), 1u);
  EXPECT_EQ(first.bodies.set[0].kind, BodyKind::static_);
  EXPECT_EQ(first.bodies.set[0].solids.size(), 1u);
  EXPECT_TRUE(first.memberships.empty());
  system.bodies().set_pose(wall, {3, 1, 0}, {0, 1, 0, 0});
  const PoseSnapshot poses = system.viewer().poses();
  ASSERT_EQ(poses.bodies.size(), 1u);
  EXPECT_FLOAT_EQ(poses.bodies[0].position[0], 3);
  EXPECT_FLOAT_EQ(poses.bodies[0].orientation[1], 1);
  EXPECT_NEAR(system.places().nearest({5, 1, 0})->distance, 1.5, 1e-12);
  system.bodies().destroy(wall);
  EXPECT_EQ(system.viewer().take_scene_changes(false).bodies.gone, std::vector{wall.slot});
}

TEST(Obstacles, refuse_to_move_and_to_be_tied) {
  System system;
  const BodyId wall = system.bodies().create_obstacle(Box{{1, 2, 0.1}});
  const BodyId ball = system.bodies().create(Sphere{0.1});
  const auto before = system.snapshot();
  EXPECT_THROW(system.bodies().set_kind(wall, BodyKind::dynamic), std::invalid_argument);
  EXPECT_THROW(system.bodies().set_kind(wall, BodyKind::resting), std::invalid_argument);
  EXPECT_THROW((void)system.particles().create(wall, {}), std::invalid_argument);
  EXPECT_THROW((void)system.bodies().create_attachment(wall, {}), std::invalid_argument);
  EXPECT_THROW((void)system.edits().combine(wall, ball), std::invalid_argument);
  EXPECT_THROW((void)system.bodies().create_obstacle(fan(1), {NAN, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)system.bodies().create_obstacle(Mesh{{{0, 0, 0}}, {{0, 1, 2}}}), std::invalid_argument);
  EXPECT_EQ(system.snapshot().bytes, before.bytes);
  system.bodies().set_active(wall, false);
  EXPECT_EQ(system.places().nearest({0, 0, 9})->body, ball);
  system.bodies().set_active(wall, true);
  EXPECT_EQ(system.bodies().kind(wall), BodyKind::static_);
}

}  // namespace
}  // namespace iota
