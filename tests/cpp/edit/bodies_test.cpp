// SPDX-License-Identifier: Apache-2.0
#include "edit/bodies.h"
#include "tests/cpp/refused.h"
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace iota {
namespace {

TEST(Solid, is_created_with_its_mass_pose_and_motion) {
  System system;
  const double angle = 0.7;
  const Quaternion turn{0, std::sin(angle / 2), 0, std::cos(angle / 2)};
  const Vec3 velocity{1, 2, 3}, spin{0.5, -1, 2}, position{4, 5, 6};
  const BodyId box = system.bodies().create(Box{{0.2, 0.4, 0.6}}, {.density = 500,
                                                                   .position = position,
                                                                   .orientation = turn,
                                                                   .velocity = velocity,
                                                                   .spin = spin,
                                                                   .attachments = {{0.1, 0, 0}}});
  EXPECT_NEAR(system.bodies().mass(box), 500 * 0.2 * 0.4 * 0.6, 1e-12);
  EXPECT_LT(norm(system.bodies().center_of_mass(box) - position), 1e-14);
  EXPECT_LT(norm(system.bodies().velocity(box) - velocity), 1e-14);
  EXPECT_LT(norm(system.bodies().angular_velocity(box) - spin), 1e-13);
  const ParticleId corner = system.bodies().attachments(box)[0];
  const Vec3 lever{0.1 * std::cos(angle), 0, -0.1 * std::sin(angle)};
  EXPECT_LT(norm(system.particles().position(corner) - position - lever), 1e-14);
  EXPECT_LT(norm(system.particles().velocity(corner) - velocity - cross_of(spin, lever)), 1e-13);
}

TEST(MassProperties, of_a_body_are_those_that_are_set_whatever_its_shapes_are) {
  for (const double size : {1e-3, 1.0, 1e5}) {
    System system;
    const Vec3 velocity{size, 0, 0}, spin{1, 2, -3}, center{0.1 * size, -0.05 * size, 0.02 * size};
    const BodyId body =
        system.bodies().create(Box{{size, size, size}}, {.mass = 1, .velocity = velocity, .spin = spin});
    const BodyId ball = system.bodies().create(Sphere{size / 2}, {.mass = 3, .position = {2 * size, 0, 0}});
    (void)system.edits().combine(body, ball);
    system.bodies().set_velocity(body, velocity), system.bodies().set_angular_velocity(body, spin);
    const Vec3 former = system.bodies().center_of_mass(body);
    const double unit = size * size;
    const Matrix3 inertia{Vec3{2 * unit, 0.1 * unit, 0}, Vec3{0.1 * unit, 3 * unit, 0.2 * unit},
                          Vec3{0, 0.2 * unit, 4 * unit}};
    system.bodies().set_mass_properties(body, 5, center, inertia);
    EXPECT_NEAR(system.bodies().mass(body), 5, 1e-12);
    EXPECT_LT(norm(system.bodies().center_of_mass(body) - center), 1e-12 * size);
    const Matrix3 now = system.bodies().inertia(body);
    for (int i = 0; i < 3; ++i) EXPECT_LT(norm(now[i] - inertia[i]), 1e-12 * unit);
    EXPECT_LT(norm(system.bodies().angular_velocity(body) - spin), 1e-11);
    EXPECT_LT(norm(system.bodies().velocity(body) - velocity - cross_of(spin, center - former)), 1e-11 * size);
    const std::vector<SolidView> solids = system.bodies().solids(body);
    ASSERT_EQ(solids.size(), 2u);
    EXPECT_LT(norm(solids[0].position), 1e-12 * size);
    EXPECT_LT(norm(solids[1].position - Vec3{2 * size, 0, 0}), 1e-12 * size);
    system.validate();
  }
}

TEST(MassProperties, that_no_body_has_are_refused) {
  System system;
  const BodyId box = system.bodies().create(Box{{1, 1, 1}}, {.mass = 1});
  const auto refused = [&](BodyId body, double mass, const Matrix3& inertia) {
    EXPECT_THROW(system.bodies().set_mass_properties(body, mass, {}, inertia), std::invalid_argument);
  };
  const Matrix3 good{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  refused(box, 0, good), refused(box, std::nan(""), good);
  refused(box, 1, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 2.1}});
  refused(box, 1, {Vec3{1, 0.1, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  refused(box, 1, {Vec3{std::nan(""), 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  refused(box, 1, {});
  refused(system.bodies().create_obstacle(Box{{1, 1, 1}}), 1, good);
  refused(system.bodies().create(), 1, good);
  (void)system.bodies().create_attachment(box, {1, 0, 0});
  refused(box, 1, good);
  EXPECT_NEAR(system.bodies().mass(box), 1, 1e-12);
}

TEST(Rod, has_the_moment_of_inertia_of_a_cylinder_about_its_center) {
  for (const double size : {1e-3, 1.0, 1e3}) {
    System system;
    const BodyId rod = system.bodies().create();
    const double length = 2 * size, radius = 0.3 * size, mass = 5;
    system.particles().create(rod, {0, 0, 0}, 1, {0, -size, 0});
    system.particles().create(rod, {length, 0, 0}, 1, {0, size, 0});  // turns by 1 rad/s about z
    system.bodies().set_rod(rod, mass, radius);
    EXPECT_NEAR(system.bodies().mass(rod), mass, 1e-14);
    const double moment = mass * (3 * radius * radius + length * length) / 12;
    EXPECT_NEAR(system.bodies().angular_momentum(rod).z / moment, 1, 1e-13);
    EXPECT_NEAR(system.energy().kinetic / (0.5 * moment), 1, 1e-13);
  }
}

TEST(Pose, that_is_assigned_turns_velocities_along_and_keeps_the_energy) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId box = system.bodies().create(
      Box{{0.2, 0.4, 0.6}}, {.position = {1, 0, 0}, .velocity = {1, 2, 3}, .spin = {0, 0, 4}, .attachments = {{}}});
  const double kinetic = system.energy().kinetic;
  const double half = std::numbers::pi / 4;  // a quarter turn about x: y becomes z
  system.bodies().set_pose(box, {7, 8, 9}, {std::sin(half), 0, 0, std::cos(half)});
  EXPECT_LT(norm(system.bodies().center_of_mass(box) - Vec3{7, 8, 9}), 1e-13);
  EXPECT_LT(norm(system.bodies().angular_velocity(box) - Vec3{0, -4, 0}), 1e-12);
  EXPECT_LT(norm(system.bodies().velocity(box) - Vec3{1, 2, 3}), 1e-13);
  EXPECT_NEAR(system.energy().kinetic / kinetic, 1, 1e-13);
}

TEST(Velocities, that_are_assigned_change_only_the_named_particles) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId box =
      system.bodies().create(Box{{0.2, 0.4, 0.6}}, {.velocity = {1, 2, 3}, .spin = {3, 0, 4}, .attachments = {{}}});
  system.bodies().set_velocity(box, {-1, 0, 0});
  EXPECT_LT(norm(system.bodies().velocity(box) - Vec3{-1, 0, 0}), 1e-14);
  EXPECT_LT(norm(system.bodies().angular_velocity(box) - Vec3{3, 0, 4}), 1e-12);
  system.bodies().set_angular_velocity(box, {0, 5, 0});
  EXPECT_LT(norm(system.bodies().velocity(box) - Vec3{-1, 0, 0}), 1e-14);
  EXPECT_LT(norm(system.bodies().angular_velocity(box) - Vec3{0, 5, 0}), 1e-12);
}

TEST(Kind, that_a_body_cannot_have_is_refused_with_the_way_out) {
  System system;
  const BodyId ground = system.bodies().create(HalfSpace{}, {.mass = 1, .kind = BodyKind::static_});
  const BodyId body = system.bodies().create();
  system.particles().create(body, {});
  system.bodies().set_kind(body, BodyKind::static_);
  const std::uint64_t before = system.state_hash();
  expect_refused(
      system, [&] { system.bodies().set_kind(ground, BodyKind::dynamic); }, "it can only be static or scripted");
  expect_refused(system, [&] { system.bodies().set_kind(body, BodyKind::resting); }, "make it dynamic first");
  EXPECT_EQ(system.state_hash(), before);
  system.bodies().set_kind(ground, BodyKind::scripted);
  EXPECT_EQ(system.bodies().kind(ground), BodyKind::scripted);
}

TEST(Shape, or_rod_that_no_body_can_have_is_refused_before_anything_changes) {
  System system;
  const BodyId three = system.bodies().create();
  for (const double x : {0.0, 1.0, 3.0}) system.particles().create(three, {x, 0, 0});
  const std::uint64_t before = system.state_hash();
  expect_refused(system, [&] { system.bodies().set_rod(three, 1, 0.1); }, "exactly two massive particles");
  expect_refused(system, [&] { system.bodies().set_rod(three, 1, 0); }, "radius must be above 0");
  expect_refused(system, [&] { system.bodies().create(Box{}, {.density = 0}); }, "density");
  expect_refused(system, [&] { system.bodies().create(Box{}, {.mass = -1}); }, "mass");
  expect_refused(system, [&] { system.bodies().create(Box{}, {.orientation = {0, 0, 0, 0}}); }, "orientation");
  expect_refused(system, [&] { (void)system.bodies().create_attachment(three, {}); }, "use create_particle");
  EXPECT_EQ(system.state_hash(), before);
}

TEST(BodyColor, is_kept_told_to_viewers_taken_back_and_refused_where_it_is_none) {
  System system;
  const BodyId box = system.bodies().create(Box{{1, 1, 1}}, {.density = 1000});
  (void)system.viewer().take_scene_changes(true);
  EXPECT_EQ(system.bodies().color(box), std::nullopt);
  system.bodies().set_color(box, 0xff6347);
  EXPECT_EQ(system.bodies().color(box), 0xff6347U);
  const SceneChanges changes = system.viewer().take_scene_changes(false);
  ASSERT_EQ(changes.bodies.set.size(), 1U);
  EXPECT_EQ(changes.bodies.set[0].color, 0xff6347U);
  expect_refused(system, [&] { system.bodies().set_color(box, 0x1000000); }, "color must be at most 0xffffff");
  system.bodies().set_color(box, std::nullopt);
  EXPECT_EQ(system.bodies().color(box), std::nullopt);
}

TEST(Body, that_is_destroyed_takes_its_momentum_and_energy_out_of_the_book) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId kept = system.bodies().create(), gone = system.bodies().create();
  system.particles().create(kept, {}, 2, {1, 0, 0});
  system.particles().create(gone, {5, 0, 0}, 3, {0, 2, 0});
  (void)system.step(0.01);
  system.bodies().destroy(gone);
  (void)system.step(0.01);
  EXPECT_FALSE(system.bodies().contains(gone));
  EXPECT_LT(norm(system.momentum() - Vec3{2, 0, 0}), 1e-15);
  EXPECT_NEAR(system.energy().kinetic, 1, 1e-15);
  EXPECT_NEAR(system.energy().balance(), 0, 1e-14);
}

}  // namespace
}  // namespace iota
