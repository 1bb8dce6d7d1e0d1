// SPDX-License-Identifier: Apache-2.0
#include "edit/nails.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace iota {
namespace {

struct Dumbbell {
  System system{SystemOptions{.gravity = {}}};
  BodyId body = system.bodies().create();
  ParticleId left = system.particles().create(body, {0, 0, 0}, 1, {0, -1, 0});
  ParticleId right = system.particles().create(body, {2, 0, 0}, 1, {0, 1, 0});
};

TEST(Nail, keeps_the_angular_momentum_about_its_place) {
  // Two masses of 1 kg at distance 2 turn about their middle: L about the left one is 2 kg m^2/s, and so is it after the
  // nail, when the right one alone moves: at 1 m/s.
  Dumbbell d;
  d.system.particles().nail(d.left);
  (void)d.system.step(1e-6);
  EXPECT_LT(norm(d.system.particles().velocity(d.left)), 1e-12);
  EXPECT_NEAR(d.system.particles().velocity(d.right).y, 1, 1e-6);
}

TEST(Nail, that_is_moved_is_reached_at_the_end_of_the_next_step) {
  Dumbbell d;
  d.system.particles().nail(d.left);
  (void)d.system.step(0.01);
  for (const Vec3& place : {Vec3{0.01, 0, 0}, Vec3{0.01, 0.02, 0}, Vec3{0.01, 0.02, -0.03}}) {
    d.system.particles().nail(d.left, place);
    EXPECT_NE(d.system.particles().position(d.left), place) << "not before the step";
    (void)d.system.step(0.01);
    EXPECT_LT(norm(d.system.particles().position(d.left) - place), 1e-12);
    EXPECT_NEAR(norm(d.system.particles().position(d.right) - place), 2, 1e-9);
  }
}

TEST(Nail, that_brings_a_solid_from_afar_does_not_mirror_it) {
  for (const double size : {1e-3, 1.0, 1e3})
    for (const Vec3& way :
         {Vec3{5, 0, 0}, Vec3{-5, 0, 0}, Vec3{0, 5, 0}, Vec3{0, -5, 0}, Vec3{0, 0, 5}, Vec3{0, 0, -5}, Vec3{5, 5, 5}}) {
      System system{SystemOptions{.gravity = {}}};
      const BodyId body = system.bodies().create();
      std::vector<ParticleId> corners;
      for (const Vec3& x : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
        corners.push_back(system.particles().create(body, size * x, 1));
      system.particles().nail(corners[0], size * way);
      const auto edge = [&](int i) {
        return system.particles().position(corners[i]) - system.particles().position(corners[0]);
      };
      EXPECT_NEAR(dot(edge(1), cross(edge(2), edge(3))) / (size * size * size), 1, 1e-6);
    }
}

TEST(Nail, of_a_point_that_a_static_body_holds_may_not_move_it) {
  Dumbbell d;
  d.system.bodies().set_kind(d.body, BodyKind::static_);
  const std::uint64_t before = d.system.state_hash();
  try {
    d.system.particles().nail(d.left, {1, 1, 1});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("make it dynamic or scripted to move it"), std::string::npos);
  }
  EXPECT_EQ(d.system.state_hash(), before);
}

TEST(Nail, that_is_released_lets_go_and_a_release_of_nothing_changes_nothing) {
  Dumbbell d;
  const std::uint64_t before = d.system.state_hash();
  d.system.particles().release(d.left);
  EXPECT_EQ(d.system.state_hash(), before);
  d.system.particles().nail(d.left);
  EXPECT_TRUE(d.system.particles().is_nailed(d.left));
  d.system.particles().release(d.left);
  EXPECT_FALSE(d.system.particles().is_nailed(d.left));
  const Vec3 momentum = d.system.momentum();
  for (int i = 0; i < 10; ++i) (void)d.system.step(0.01);
  EXPECT_LT(norm(d.system.momentum() - momentum), 1e-12) << "no force from outside";
}

}  // namespace
}  // namespace iota
