// SPDX-License-Identifier: Apache-2.0
// Velocities are those of the bodies that one sees: after a step of the mid-point modes they meet rows and hinges, and what that
// takes from the motion goes back to it.
#include "modes.h"
#include "scenes/chain.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace iota {
namespace {

/// The largest rate at which two particles of one body approach or part, over the largest speed.
double worst_stretch_rate(const System& system, const std::vector<BodyId>& bodies) {
  double rate = 0, speed = 0;
  for (const BodyId body : bodies) {
    const auto particles = system.bodies().particles(body);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      speed = std::max(speed, norm(system.particles().velocity(particles[i])));
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 apart = system.particles().position(particles[i]) - system.particles().position(particles[j]);
        const Vec3 relative = system.particles().velocity(particles[i]) - system.particles().velocity(particles[j]);
        rate = std::max(rate, std::abs(dot(apart, relative)) / norm(apart));
      }
    }
  }
  return rate / speed;
}

struct ChainCase {
  int links;
  bool rods;
  double hz;
};
class WhippingChain : public testing::TestWithParam<ChainCase> {};

TEST_P(WhippingChain, has_rigid_velocities_and_keeps_its_energy) {
  const auto [links, rods, hz] = GetParam();
  System system;
  const auto chain = scenes::make_chain(system, {.links = links, .link_length = 1.0 / links, .rods = rods});
  const double start = system.energy().total();
  double kinetic = 0, stretch = 0;
  for (int i = 0; i < 2 * hz; ++i) {
    const StepReport report = system.step(1 / hz);
    kinetic = std::max(kinetic, report.energy.kinetic);
    EXPECT_EQ(report.fallbacks, 0);
    stretch = std::max(stretch, worst_stretch_rate(system, chain.links));
  }
  EXPECT_LT(stretch, 1e-9);
  EXPECT_EQ(system.energy().made, 0);
  EXPECT_NEAR(system.energy().total(), start, 1e-7 * kinetic);
}

TEST(Pendulum, of_one_rod_keeps_its_energy_in_a_held_field) {
  System system({.gravity = {}});
  system.fields().create("energy = m*g*y", {.parameters = {{"g", 9.81}}});
  const BodyId rod = system.bodies().create();
  system.particles().nail(system.particles().create(rod, {0, 0, 0}));
  system.particles().create(rod, {0.6, -0.8, 0}, 1, {0, 0, 0.5});
  const double start = system.energy().total();
  for (int i = 0; i < 1200; ++i) (void)system.step(1.0 / 120);
  EXPECT_NEAR(system.energy().total(), start, 1e-10);
  EXPECT_NEAR(system.energy().lost, 0, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Of, WhippingChain,
                         testing::Values(ChainCase{8, false, 60}, ChainCase{8, true, 240}, ChainCase{64, false, 120},
                                         ChainCase{64, true, 60}, ChainCase{64, true, 240}),
                         [](const auto& info) {
                           return std::to_string(info.param.links) + (info.param.rods ? "_rods_at_" : "_links_at_") +
                                  std::to_string(static_cast<int>(info.param.hz)) + "_Hz";
                         });

TEST(Velocities, of_a_chain_that_nothing_holds_keep_both_momenta_too) {
  System system({.gravity = {}});
  const auto chain = scenes::make_chain(system, {.links = 12, .rods = true, .nailed = false});
  for (std::size_t i = 0; i < chain.links.size(); ++i)
    system.bodies().set_angular_velocity(chain.links[i], {0, 2.0 * std::sin(1.0 * double(i)), 5});
  (void)system.step(1e-6);  // they are made to fit
  const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
  const double energy = system.energy().total();
  for (int i = 0; i < 480; ++i) {
    (void)system.step(1.0 / 120);
    ASSERT_LT(worst_stretch_rate(system, chain.links), 1e-9);
  }
  EXPECT_LT(norm(system.momentum() - momentum), 1e-10);
  EXPECT_LT(norm(system.angular_momentum() - angular), 1e-9 * norm(angular));
  EXPECT_NEAR(system.energy().total(), energy, 1e-8 * energy);
}

TEST(Velocities, of_a_free_body_keep_its_spin_in_every_mode) {
  for (const auto mode : {IntegrationMode::plausible, IntegrationMode::robust, IntegrationMode::energy_keeping})
    for (const double hz : {60.0, 240.0})
      for (const Vec3& edges : {Vec3{0.2, 0.2, 0.2}, Vec3{0.1, 0.2, 0.5}}) {
        System system({.mode = mode});
        const BodyId body = system.bodies().create(Box{edges}, {.mass = 2, .velocity = {1, 2, 0}, .spin = {2, 30, 1}});
        const Vec3 spin = system.bodies().angular_momentum(body);
        const double energy = system.energy().total(), kinetic = system.energy().kinetic;
        double highest = energy;
        for (int i = 0; i < 2 * hz; ++i) highest = std::max(highest, system.step(1 / hz).energy.total());
        const std::string what = std::to_string(static_cast<int>(mode)) + " at " + std::to_string(hz);
        EXPECT_LT(norm(system.bodies().angular_momentum(body) - spin), 1e-5 * norm(spin)) << what;
        EXPECT_LT(highest, energy + 1e-9 * kinetic) << what;
        EXPECT_NEAR(system.bodies().velocity(body).y, 2 - 2 * 9.81, 1e-9) << what;
      }
}

/// Rods, or boxes, of 1 and `light` kg on a nail at the origin, or on one each: the first circles, the second swings in the y-z plane.
std::vector<std::unique_ptr<System>> make_pendulums(IntegrationMode mode, bool boxes, bool on_one_nail, double light,
                                                    std::vector<BodyId>& bodies) {
  std::vector<std::unique_ptr<System>> systems;
  ParticleId nail{};
  for (const int k : {0, 1}) {
    if (systems.empty() || !on_one_nail) systems.push_back(std::make_unique<System>(SystemOptions{.mode = mode}));
    System& system = *systems.back();
    const double mass = k == 0 ? 1 : light;
    const Vec3 end = k == 0 ? Vec3{0.5, -0.8, 0} : Vec3{0, -0.6, 0.5}, speed = k == 0 ? Vec3{0, 0, 1.5} : Vec3{};
    ParticleId top{};
    if (boxes) {
      const Vec3 center = 0.5 * end, spin = (1 / dot(end, end)) * cross(end, speed);
      bodies.push_back(system.bodies().create(
          Box{{0.1, 0.2, 0.3}},
          {.mass = mass, .position = center, .velocity = cross(spin, center), .spin = spin, .attachments = {-center}}));
      top = system.bodies().attachments(bodies.back())[0];
    } else {
      bodies.push_back(system.bodies().create());
      top = system.particles().create(bodies.back(), {0, 0, 0}, mass / 2);
      system.particles().create(bodies.back(), end, mass / 2, speed);
    }
    if (k == 1 && on_one_nail)
      (void)system.edits().combine(nail, top);
    else
      system.particles().nail(nail = top);
  }
  return systems;
}

TEST(Pendulums, on_one_nail_swing_as_each_of_them_alone) {
  for (const IntegrationMode mode : all_modes)
    for (const bool boxes : {false, true})
      for (const double light : {1.0, 1e-5}) {
        std::vector<BodyId> together, alone;
        const auto one = make_pendulums(mode, boxes, true, light, together);
        const auto two = make_pendulums(mode, boxes, false, light, alone);
        const std::string what =
            std::to_string(static_cast<int>(mode)) + (boxes ? " boxes " : " rods ") + std::to_string(light);
        double apart = 0, leaves = 0;
        for (int i = 0; i < 240; ++i) {
          for (const auto& system : one) (void)system->step(1.0 / 60);
          for (const auto& system : two) (void)system->step(1.0 / 60);
          for (const int k : {0, 1})
            apart = std::max(
                apart, norm(one[0]->bodies().center_of_mass(together[k]) - two[k]->bodies().center_of_mass(alone[k])));
          leaves = std::max(leaves, std::abs(one[0]->bodies().center_of_mass(together[1]).x));
        }
        // The end-point rule gives spins back with the energy that both have lost together.
        const bool shares = mode == IntegrationMode::plausible || mode == IntegrationMode::robust;
        EXPECT_LT(apart, shares ? 1e-2 : 1e-6) << what;
        EXPECT_LT(leaves, 1e-6) << what << ": it left its plane";
        EXPECT_EQ(one[0]->energy().made, 0) << what;
      }
}

/// Its angular momentum about the vertical stays, whatever the ball joint is with. A static body took half of it in 2 s.
TEST(Pendulums, on_static_and_scripted_bodies_swing_as_those_of_the_world) {
  for (const IntegrationMode mode : end_point_modes) {
    Vec3 in_world;
    for (const BodyKind kind : {BodyKind::dynamic, BodyKind::static_, BodyKind::scripted}) {
      System system({.mode = mode});
      const Vec3 place{0.4, -0.4, 0.1}, spin{0, 5, 0};
      const BodyId box = system.bodies().create(
          Box{{0.5, 0.3, 0.2}}, {.mass = 2, .position = place, .velocity = cross(spin, place), .spin = spin});
      JointSpec joint{.kind = ConstraintKind::ball, .a = box};
      if (kind != BodyKind::dynamic) {
        joint.b = system.bodies().create(Sphere{0.05}, {.mass = 1});
        system.bodies().set_kind(joint.b, kind);
      }
      (void)system.joints().create(joint);
      (void)system.step(1e-6);
      const auto about = [&] { return system.angular_momentum().y; };
      const double start = about();
      for (int i = 0; i < 120; ++i) (void)system.step(1.0 / 60);
      EXPECT_NEAR(about(), start, 0.01 * start);
      const Vec3 end = system.bodies().center_of_mass(box);
      if (kind == BodyKind::dynamic) in_world = end;
      EXPECT_LT(norm(end - in_world), 1e-6);
    }
  }
}

/// Gravity has no torque about the vertical through the nail, which is at the origin.
TEST(Velocities, of_what_circles_about_a_nail_keep_the_angular_momentum_about_the_vertical) {
  for (const bool block : {false, true}) {
    System system;
    if (block) {
      const BodyId top = system.bodies().create(
          Box{{0.1, 0.3, 0.5}},
          {.mass = 1, .position = {0, -0.15, -0.25}, .spin = {3, 6, 2}, .attachments = {{0, 0.15, 0.25}}});
      system.particles().nail(system.bodies().attachments(top)[0]);
    } else {
      const auto chain = scenes::make_chain(system, {.links = 8, .rods = true, .direction = {0.8, -0.6, 0}});
      for (const BodyId link : chain.links) system.bodies().set_angular_velocity(link, {0, 4, 0});
    }
    (void)system.step(1e-6);  // velocities that were assigned are made to fit
    const double start = system.angular_momentum().y, energy = system.energy().total();
    double kinetic = 0;
    for (int i = 0; i < 240; ++i) kinetic = std::max(kinetic, system.step(1.0 / 60).energy.kinetic);
    EXPECT_NEAR(system.angular_momentum().y, start, 1e-7 * std::abs(start)) << (block ? "block" : "chain");
    EXPECT_NEAR(system.energy().total(), energy, 1e-7 * kinetic) << (block ? "block" : "chain");
  }
}

TEST(Velocities, of_blocks_on_revolutes_meet_their_rows_and_hinges) {
  System system;
  std::vector<BodyId> blocks;
  std::vector<ParticleId> left, right;
  for (int i = 0; i < 5; ++i) {
    blocks.push_back(system.bodies().create(
        Box{{0.2, 0.05, 0.1}}, {.mass = 0.5, .position = {0.2 * i, 0, 0}, .attachments = {{-0.1, 0, 0}, {0.1, 0, 0}}}));
    const Vec3 at{0.2 * i - 0.1, 0, 0};
    const Vec3 axis = i % 2 ? Vec3{0, 0, 1} : Vec3{0, 0.6, 0.8};
    (void)(i == 0 ? system.joints().create(JointSpec{.a = blocks[0], .at = at, .axis = axis})
                  : system.joints().create(JointSpec{.a = blocks[i], .b = blocks[i - 1], .at = at, .axis = axis}));
  }
  const double start = system.energy().total();
  double kinetic = 0;
  for (int i = 0; i < 240; ++i) {
    const StepReport report = system.step(1.0 / 120);
    kinetic = std::max(kinetic, report.energy.kinetic);
    ASSERT_LT(worst_stretch_rate(system, blocks), 1e-9) << i;
    for (int k = 1; k < 5; ++k) {  // the hinge's place as both of its bodies carry it
      const auto a = system.bodies().attachments(blocks[k])[0], b = system.bodies().attachments(blocks[k - 1])[1];
      ASSERT_LT(norm(system.particles().velocity(a) - system.particles().velocity(b)), 1e-9) << i;
    }
  }
  EXPECT_NEAR(system.energy().total(), start, 1e-7 * kinetic);
}

TEST(Velocities, at_rest_leave_reactions_steady) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 8, .direction = {0.6, -0.8, 0}});
  system.set_damping(8);
  for (int i = 0; i < 120 * 12; ++i) (void)system.step(1.0 / 120);
  double least = 1e300, most = 0;
  for (int i = 0; i < 60; ++i) {
    (void)system.step(1.0 / 120);
    const double force = norm(system.particles().nail_force(chain.upper.front()));
    least = std::min(least, force), most = std::max(most, force);
  }
  EXPECT_NEAR(most, 0.8 * 9.81, 1e-6 * most) << "the weight";
  EXPECT_LT(most - least, 1e-6 * most);
}

/// Up to rounding m (3 g sin a) for a pendulum that was let go from the side: the force that its nail feels at each angle a.
TEST(Velocities, let_reactions_follow_the_motion_instead_of_ringing) {
  for (const double hz : {60.0, 240.0}) {
    System system;
    const BodyId link = system.bodies().create();
    const ParticleId nail = system.particles().create(link, {0, 0, 0}, 1e-3),
                     ball = system.particles().create(link, {1, 0, 0}, 2);
    system.particles().nail(nail);
    double worst = 0;
    for (int i = 0; i < 2 * hz; ++i) {
      const double before = -system.particles().position(ball).y;
      (void)system.step(1 / hz);
      const double middle = (before - system.particles().position(ball).y) / 2;
      const double force = norm(system.particles().nail_force(nail));
      worst = std::max(worst, std::abs(force - 2 * 3 * 9.81 * middle));
    }
    EXPECT_LT(worst, 600 / hz) << "an error of first order: the force is one early in the step";
  }
}

TEST(Velocities, of_a_wheel_that_a_motor_drives_need_no_torque) {
  System system({.gravity = {}});
  const BodyId wheel = system.bodies().create(Cylinder{.radius = 0.3, .length = 0.05}, {.mass = 2});
  const ConstraintId hinge = system.joints().create(
      JointSpec{.a = wheel, .at = {}, .axis = {0, 1, 0}, .angle = {.motor_speed = 40, .motor_max = 1000}});
  for (int i = 0; i < 240; ++i) (void)system.step(1.0 / 120);
  const double start = system.energy().external_work;
  double effort = 0;
  for (int i = 0; i < 120; ++i) {
    (void)system.step(1.0 / 120);
    effort = std::max(effort, std::abs(system.joints().state(hinge).effort[0].total()));
  }
  EXPECT_LT(effort, 1e-6);
  EXPECT_NEAR(system.energy().external_work, start, 1e-6);
}

}  // namespace
}  // namespace iota
