// SPDX-License-Identifier: Apache-2.0
#include "edit/body_forces.h"
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
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
