// SPDX-License-Identifier: Apache-2.0
#include "edit/body_forces.h"
#include "modes.h"
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace iota {
namespace {

struct FreeBox {
  System system{SystemOptions{.gravity = {}}};
  BodyId box = system.bodies().create(Box{{0.2, 0.4, 0.6}}, {.mass = 3, .position = {1, 2, 3}});
};

TEST(BodyForce, gives_a_body_momentum_and_angular_momentum_by_its_time_and_lever) {
  constexpr double h = 1e-3;
  const Vec3 force{5, -7, 2};
  for (const Vec3& lever : {Vec3{}, Vec3{0.1, 0.2, -0.3}, Vec3{10, 0, 0}}) {  // also beyond the body
    FreeBox free;
    free.system.bodies().apply_force(free.box, force, Vec3{1, 2, 3} + lever);
    (void)free.system.step(h);
    EXPECT_LT(norm(free.system.momentum() - h * force), 1e-13);
    EXPECT_LT(norm(free.system.bodies().angular_momentum(free.box) - h * cross_of(lever, force)), 1e-7);
    const Vec3 momentum = free.system.momentum();
    (void)free.system.step(h);
    EXPECT_LT(norm(free.system.momentum() - momentum), 1e-13) << "for one step only";
  }
}

TEST(BodyTorque, turns_a_body_by_its_moments_of_inertia_and_moves_no_center) {
  constexpr double h = 1e-4;
  FreeBox free;
  const Vec3 torque{0.3, -0.2, 0.1};
  free.system.bodies().apply_torque(free.box, torque);
  (void)free.system.step(h);
  const Vec3 turn = free.system.bodies().angular_velocity(free.box);
  const auto moment = [](double a, double b) { return 3 * (a * a + b * b) / 12; };
  EXPECT_NEAR(turn.x, h * torque.x / moment(0.4, 0.6), 1e-9);
  EXPECT_NEAR(turn.y, h * torque.y / moment(0.2, 0.6), 1e-9);
  EXPECT_NEAR(turn.z, h * torque.z / moment(0.2, 0.4), 1e-9);
  EXPECT_LT(norm(free.system.momentum()), 1e-14);
}

TEST(BodyTorque, gives_a_free_body_its_angular_momentum_in_every_mode_however_far_it_turns_in_a_step) {
  for (const IntegrationMode mode : all_modes)
    for (const double hz : {60.0, 240.0}) {
      FreeBox free;
      free.system.set_mode(mode);
      const double strength = 5;  // N m: 50 to 140 rad/s
      for (int i = 0; i < hz; ++i) {
        free.system.bodies().apply_torque(free.box, {0, strength, 0});
        (void)free.system.step(1 / hz);
      }
      const Vec3 reached = free.system.bodies().angular_momentum(free.box);
      EXPECT_NEAR(norm(reached - Vec3{0, strength, 0}), 0, 1e-4 * strength)
          << "mode " << int(mode) << ", " << hz << " Hz";
      EXPECT_LT(norm(free.system.momentum()), 1e-10);
    }
}

TEST(BodyTorque, of_any_direction_turns_any_body_to_round_off_in_energy_keeping) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
    System system{SystemOptions{.gravity = {}}};
    const BodyId body = system.bodies().create();
    for (unsigned i = 0; i < 3 + seed % 5; ++i)
      system.particles().create(body, {number(), number(), number()}, 1.5 + number(), {});
    Vec3 sum;
    double worst_load = 0;
    for (int i = 0; i < 60; ++i) {
      const Vec3 torque{20 * number(), 20 * number(), 20 * number()};
      system.bodies().apply_torque(body, torque);
      system.bodies().apply_force(body, {0, 3, 0}, system.bodies().center_of_mass(body) + Vec3{0, 0, 2});
      sum += (1.0 / 60) * (torque + Vec3{-6, 0, 0});
      (void)system.step(1.0 / 60);
      worst_load = std::max(worst_load, norm(system.bodies().net_torque(body) - torque - Vec3{-6, 0, 0}));
    }
    EXPECT_LT(norm(system.bodies().angular_momentum(body) - sum), 1e-9) << seed;
    EXPECT_LT(worst_load, 0.1) << "the load from outside, to the tolerance of the solve";
    EXPECT_NEAR(system.energy().kinetic, system.energy().external_work, 1e-5 * system.energy().kinetic);
  }
}

TEST(BodyTorque, wakes_a_sleeping_body_and_ends_with_it) {
  FreeBox free;
  free.system.set_rest({.after = 0.02});
  for (int i = 0; i < 10; ++i) (void)free.system.step(0.01);
  ASSERT_EQ(free.system.bodies().kind(free.box), BodyKind::resting);
  free.system.bodies().apply_torque(free.box, {0, 1, 0});
  const Snapshot pending = free.system.snapshot();
  (void)free.system.step(0.01);
  EXPECT_NEAR(free.system.bodies().angular_momentum(free.box).y, 0.01, 1e-9);
  free.system.restore(pending);
  (void)free.system.step(0.01);
  EXPECT_NEAR(free.system.bodies().angular_momentum(free.box).y, 0.01, 1e-9) << "a snapshot has the torque";
  free.system.bodies().apply_torque(free.box, {0, 1, 0});
  free.system.bodies().destroy(free.box);
  EXPECT_EQ(free.system.validate(), std::vector<std::string>{});
}

TEST(BodyTorque, about_the_line_of_all_particles_is_refused_and_across_it_is_not) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId rod = system.bodies().create();
  system.particles().create(rod, {0, 0, 0});
  system.particles().create(rod, {2, 0, 0});
  try {
    system.bodies().apply_torque(rod, {1, 0, 0});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("on one line"), std::string::npos) << error.what();
  }
  system.bodies().apply_torque(rod, {0, 0, 1});
  (void)system.step(1e-3);
  EXPECT_NEAR(system.angular_momentum().z, 1e-3, 1e-9);
}

TEST(BodyMass, scales_momenta_and_keeps_velocities) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId rod = system.bodies().create();
  system.particles().create(rod, {0, 0, 0}, 1, {1, 2, 3});
  system.particles().create(rod, {2, 0, 0}, 1, {1, 4, 3});
  system.bodies().set_rod(rod, 5, 0.1);
  system.bodies().set_angular_velocity(rod, {3, 0, 1});  // its own spin, too
  const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
  const Vec3 velocity = system.bodies().velocity(rod), turn = system.bodies().angular_velocity(rod);
  system.bodies().set_mass(rod, 10);
  EXPECT_NEAR(system.bodies().mass(rod), 10, 1e-14);
  EXPECT_LT(norm(system.momentum() - 2 * momentum), 1e-13);
  EXPECT_LT(norm(system.angular_momentum() - 2 * angular), 1e-13);
  EXPECT_LT(norm(system.bodies().velocity(rod) - velocity), 1e-14);
  EXPECT_LT(norm(system.bodies().angular_velocity(rod) - turn), 1e-14);
}

TEST(BodyName, is_kept_taken_back_and_refused_where_it_is_too_long) {
  System system;
  const BodyId body = system.bodies().create();
  EXPECT_EQ(system.bodies().name(body), "");
  system.bodies().set_name(body, "left wheel");
  EXPECT_EQ(system.bodies().name(body), "left wheel");
  EXPECT_THROW(system.bodies().set_name(body, std::string(1000, 'x')), std::invalid_argument);
  EXPECT_EQ(system.bodies().name(body), "left wheel");
  system.bodies().set_name(body, "");
  EXPECT_EQ(system.bodies().name(body), "");
}

}  // namespace
}  // namespace iota
