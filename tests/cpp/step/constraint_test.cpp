// SPDX-License-Identifier: Apache-2.0
// Every kind of constraint against what a textbook says of it.
#include "gravity.h"
#include "math/mat3.h"
#include "scenes/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace iota {
namespace {

using std::numbers::pi;
/// A solid block as eight equal corner masses: inertia m (b^2 + c^2) / 4 about each axis through its center.
BodyId make_block(System& system, const Vec3& center, const Vec3& size, double mass, const Vec3& velocity = {}) {
  const BodyId body = system.bodies().create();
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5})
        system.particles().create(body, center + Vec3{x * size.x, y * size.y, z * size.z}, mass / 8, velocity);
  return body;
}

/// Runs for `seconds` and checks at each step that the structure stays whole and the energy book adds up.
template <class EachStep>
void run(System& system, double seconds, double dt, EachStep each) {
  const auto book = [](const Energy& e) { return e.balance(); };
  double start = 0, largest = 1e-3;
  const long steps = std::lround(seconds / dt);
  for (long i = 0; i < steps; ++i) {
    const StepReport report = system.step(dt);
    ASSERT_TRUE(std::isfinite(report.energy.total())) << "step " << i;
    EXPECT_EQ(report.unconverged, 0) << "step " << i;
    if (i == 0) start = book(report.energy);
    largest = std::max({largest, report.energy.kinetic, std::abs(report.energy.potential)});
    ASSERT_NEAR(book(report.energy), start, 1e-7 * largest) << "step " << i;
    each(report);
  }
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}
void run(System& system, double seconds, double dt) {
  run(system, seconds, dt, [](const StepReport&) {});
}

TEST(Revolute, a_block_on_an_axle_swings_as_a_physical_pendulum) {
  System system;
  const double d = 0.5, angle = 0.1;  // center below the axle by d
  const Vec3 center{d * std::sin(angle), -d * std::cos(angle), 0};
  const BodyId block = make_block(system, center, {0.2, 0.4, 0.3}, 2);
  const ConstraintId joint =
      system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = block, .at = {}, .axis = {0, 0, 1}});
  const double inertia = 2 * ((0.2 * 0.2 + 0.4 * 0.4) / 4 + d * d);
  const double period = 2 * pi * std::sqrt(inertia / (2 * g * d)) * (1 + angle * angle / 16);
  double last = system.joints().state(joint).coordinate[0] + angle, crossings = 0, first = 0, latest = 0;
  run(system, 6, 1e-3, [&](const StepReport& report) {
    const ConstraintState state = system.joints().state(joint);
    const double now = state.coordinate[0] + angle;
    if (last < 0 && now >= 0) {
      latest = report.time - 1e-3 * now / (now - last);
      if (++crossings == 1) first = latest;
    }
    last = now;
    EXPECT_NEAR(system.bodies().center_of_mass(block).z, 0, 1e-9);
    EXPECT_LT(state.gap, 1e-9);
  });
  ASSERT_GT(crossings, 2);
  EXPECT_NEAR((latest - first) / (crossings - 1), period, 1e-4 * period);
}

TEST(Revolute, its_reaction_at_rest_is_the_weight_and_its_moment) {
  System system;
  const BodyId block = make_block(system, {0.3, 0, 0}, {0.2, 0.2, 0.2}, 2);
  const ConstraintId joint =
      system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = block, .at = {}, .axis = {1, 0, 0}});
  run(system, 0.5, 1.0 / 120);
  const ConstraintState state = system.joints().state(joint);
  EXPECT_NEAR(norm(state.force - Vec3{0, 2 * g, 0}), 0, 1e-5);
  EXPECT_NEAR(norm(state.torque - Vec3{0, 0, 0.3 * 2 * g}), 0, 1e-5);
}

TEST(Weld, a_cantilever_carries_m_g_l) {
  System system;
  const BodyId root = make_block(system, {0, 0, 0}, {0.2, 0.2, 0.2}, 1);
  const BodyId beam = make_block(system, {0.6, 0, 0}, {1, 0.1, 0.1}, 3);
  const ConstraintId wall = system.joints().create(JointSpec{.kind = ConstraintKind::weld, .a = root, .at = {}});
  const ConstraintId weld =
      system.joints().create(JointSpec{.kind = ConstraintKind::weld, .a = beam, .b = root, .at = {0.1, 0, 0}});
  run(system, 0.5, 1.0 / 120);
  EXPECT_NEAR(norm(system.joints().state(weld).force - Vec3{0, 3 * g, 0}), 0, 1e-5);
  EXPECT_NEAR(norm(system.joints().state(weld).torque - Vec3{0, 0, 3 * g * 0.5}), 0, 1e-5);
  EXPECT_NEAR(norm(system.joints().state(wall).force - Vec3{0, 4 * g, 0}), 0, 1e-5);
  EXPECT_NEAR(norm(system.joints().state(wall).torque - Vec3{0, 0, 3 * g * 0.6}), 0, 1e-5);
  EXPECT_NEAR(norm(system.bodies().center_of_mass(beam) - Vec3{0.6, 0, 0}), 0, 1e-9);
}

TEST(Ball, two_blocks_keep_a_common_point_and_their_momenta) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId a = make_block(system, {-0.5, 0, 0}, {0.8, 0.2, 0.3}, 1, {0, 1, 0});
  const BodyId b = make_block(system, {0.5, 0, 0}, {0.8, 0.3, 0.2}, 2, {0, 0, 1});
  const Vec3 momentum = system.momentum(), spin = system.angular_momentum();
  const ConstraintId ball = system.joints().create(JointSpec{.kind = ConstraintKind::ball, .a = a, .b = b, .at = {}});
  run(system, 2, 1.0 / 120, [&](const StepReport&) { EXPECT_LT(system.joints().state(ball).gap, 1e-9); });
  EXPECT_NEAR(norm(system.momentum() - momentum), 0, 1e-11);
  EXPECT_NEAR(norm(system.angular_momentum() - spin), 0, 1e-10);
}

TEST(Prismatic, a_block_on_an_incline_accelerates_by_g_sin) {
  System system;
  const double slope = 0.5;
  const Vec3 down{std::cos(slope), -std::sin(slope), 0};
  const BodyId block = make_block(system, {0.1, 0.2, 0.3}, {0.2, 0.1, 0.3}, 2);
  const ConstraintId joint =
      system.joints().create(JointSpec{.kind = ConstraintKind::prismatic, .a = block, .at = {0, 0.2, 0}, .axis = down});
  run(system, 1, 1.0 / 120);
  const ConstraintState state = system.joints().state(joint);
  EXPECT_NEAR(state.speed[1], g * std::sin(slope), 1e-6);
  EXPECT_NEAR(state.coordinate[1], g * std::sin(slope) / 2, 0.05);
  EXPECT_NEAR(norm(system.bodies().center_of_mass(block) - Vec3{0.1, 0.2, 0.3} - state.coordinate[1] * down), 0, 1e-8);
}

TEST(Prismatic, a_bead_of_one_particle_slides_on_a_straight_wire) {
  System system;
  const BodyId bead = system.bodies().create();
  const ParticleId p = system.particles().create(bead, {1, 2, 3}, 0.5);
  const ConstraintId wire = system.joints().create(
      JointSpec{.kind = ConstraintKind::prismatic, .a = bead, .at = {1, 2, 3}, .axis = {1, -1, 0}});
  run(system, 1, 1.0 / 120);
  EXPECT_NEAR(system.particles().position(p).z, 3, 1e-9);
  EXPECT_NEAR(system.particles().position(p).x - 1, 2 - system.particles().position(p).y, 1e-9);
  EXPECT_NEAR(system.joints().state(wire).speed[1], g * std::sqrt(0.5), 1e-6);
}

TEST(Cylindrical, slides_and_turns_independently) {
  System system;
  const BodyId block = make_block(system, {0, 0, 0}, {0.2, 0.3, 0.4}, 2);
  const ConstraintId joint =
      system.joints().create(JointSpec{.kind = ConstraintKind::cylindrical, .a = block, .at = {}, .axis = {0, 1, 0}});
  const auto particles = system.bodies().particles(block);
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 x = system.particles().position(particles[i]);
    system.particles().set_velocity(particles[i], cross(Vec3{0, 3, 0}, x));
  }
  run(system, 1, 1.0 / 240);
  const ConstraintState state = system.joints().state(joint);
  EXPECT_NEAR(state.speed[0], 3, 1e-8);
  EXPECT_NEAR(state.coordinate[0], 3, 1e-2);
  EXPECT_NEAR(state.speed[1], -g, 1e-6);
}

TEST(Universal, keeps_its_axes_perpendicular_and_transmits_the_known_ratio) {
  // Input shaft along x, output shaft bent by beta in the x-z plane: tan(out) = tan(in) cos(beta),
  // counted from where the input's axis is at right angles to both shafts.
  System system{SystemOptions{.gravity = {}}};
  const double beta = 0.5;
  const Vec3 out_axis{std::cos(beta), 0, std::sin(beta)};
  const BodyId in = make_block(system, {-0.5, 0, 0}, {0.6, 0.1, 0.1}, 1);
  const BodyId out = make_block(system, 0.5 * out_axis, {0.6, 0.1, 0.1}, 1);
  const ConstraintId in_bearing = system.joints().create(JointSpec{.kind = ConstraintKind::revolute,
                                                                   .a = in,
                                                                   .at = {-0.5, 0, 0},
                                                                   .axis = {1, 0, 0},
                                                                   .angle = {.motor_speed = 2, .motor_max = 1e3}});
  const ConstraintId out_bearing = system.joints().create(
      JointSpec{.kind = ConstraintKind::revolute, .a = out, .at = 0.5 * out_axis, .axis = out_axis});
  const ConstraintId cross_joint =
      system.joints().create(JointSpec{.kind = ConstraintKind::universal,
                                       .a = in,
                                       .b = out,
                                       .at = {},
                                       .axis = {0, 1, 0},
                                       .second_axis = {-std::sin(beta), 0, std::cos(beta)}});
  run(system, 4, 1.0 / 240, [&](const StepReport&) {
    EXPECT_LT(system.joints().state(cross_joint).gap, 1e-8);
    const double input = system.joints().state(in_bearing).coordinate[0],
                 output = system.joints().state(out_bearing).coordinate[0];
    EXPECT_NEAR(std::sin(output) * std::cos(input), std::sin(input) * std::cos(output) * std::cos(beta), 1e-6);
  });
  EXPECT_NEAR(system.joints().state(in_bearing).coordinate[0], 8, 0.05);
}

TEST(Universal, both_its_angles_are_those_that_its_two_axes_have_turned_by) {
  const Vec3 first{1, 0, 0}, second{0, 0.6, 0.8};
  for (const double phi : {-1.2, 0.0, 0.4, 3.0})
    for (const double psi : {-0.9, 0.0, 0.7, 2.5}) {
      System system{SystemOptions{.gravity = {}}};
      const BodyId block = system.bodies().create(Box{{1, 2, 3}});
      const ConstraintId joint = system.joints().create(
          JointSpec{.kind = ConstraintKind::universal, .a = block, .axis = first, .second_axis = second});
      system.bodies().set_pose(block, {}, multiply(axis_angle(second, psi), axis_angle(first, phi)));
      const auto angles = system.joints().state(joint).coordinate;
      EXPECT_NEAR(std::remainder(angles[0] - phi, 2 * std::numbers::pi), 0, 1e-12);
      EXPECT_NEAR(std::remainder(angles[2] - psi, 2 * std::numbers::pi), 0, 1e-12);
    }
}

TEST(Universal, each_angle_has_its_own_motor_and_stops) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId block = system.bodies().create(Box{{1, 0.2, 0.3}}, {.mass = 1});
  const ConstraintId joint = system.joints().create(JointSpec{.kind = ConstraintKind::universal,
                                                              .a = block,
                                                              .axis = {1, 0, 0},
                                                              .second_axis = {0, 1, 0},
                                                              .angle = {.motor_speed = 2, .motor_max = 50},
                                                              .second_angle = {.upper = 0.5}});
  system.bodies().set_angular_velocity(block, {0, 1, 0});
  double largest = 0;
  run(system, 1.5, 1.0 / 240,
      [&](const StepReport&) { largest = std::max(largest, system.joints().state(joint).coordinate[2]); });
  const ConstraintState state = system.joints().state(joint);
  EXPECT_NEAR(state.coordinate[0], 3, 0.02);
  EXPECT_NEAR(state.speed[0], 2, 1e-4);
  EXPECT_NEAR(largest, 0.5, 1e-3) << "it swings to its stop, and no further";
  system.joints().set_coordinate(joint, JointCoordinate::second_angle, {.motor_speed = -0.5, .motor_max = 50});
  run(system, 1, 1.0 / 240, [](const StepReport&) {});
  EXPECT_NEAR(system.joints().state(joint).speed[2], -0.5, 1e-6);
}

TEST(Orientation, a_block_falls_freely_without_turning) {
  System system;
  const BodyId block = make_block(system, {0, 0, 0}, {0.2, 0.3, 0.4}, 2);
  system.joints().create(JointSpec{.kind = ConstraintKind::orientation, .a = block});
  const auto particles = system.bodies().particles(block);
  const Vec3 arm = system.particles().position(particles[7]) - system.particles().position(particles[0]);
  for (int i = 0; i < 120; ++i) {
    system.particles().apply_force(particles[7], {1, 0, 0});
    (void)system.step(1.0 / 120);
  }
  EXPECT_NEAR(norm(system.particles().position(particles[7]) - system.particles().position(particles[0]) - arm), 0,
              1e-9);
  EXPECT_NEAR(system.momentum().x, 1, 1e-9);
}

TEST(Rod, two_points_keep_their_distance_and_it_tells_the_centripetal_force) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  const ParticleId p = system.particles().create(a, {1, 0, 0}, 2, {0, 3, 0}),
                   q = system.particles().create(b, {-1, 0, 0}, 2, {0, -3, 0});
  const ConstraintId rod = system.joints().create(DistanceSpec{.kind = ConstraintKind::rod, .p = p, .q = q});
  run(system, 1, 1e-3, [&](const StepReport&) {
    EXPECT_NEAR(norm(system.particles().position(p) - system.particles().position(q)), 2, 1e-9);
  });
  EXPECT_NEAR(norm(system.joints().state(rod).force), 2 * 9.0, 1e-3);
}

TEST(Rope, is_slack_in_flight_and_then_taut) {
  System system;
  const BodyId anchor = system.bodies().create({.kind = BodyKind::static_}), ball = system.bodies().create();
  const ParticleId p = system.particles().create(anchor, {0, 0, 0}),
                   q = system.particles().create(ball, {0, 0, 0}, 1, {1, 0, 0});
  const ConstraintId rope =
      system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = p, .q = q, .length = 1});
  bool was_slack = false, was_taut = false;
  run(system, 3, 1.0 / 240, [&](const StepReport& report) {
    const Vec3 x = system.particles().position(q);
    EXPECT_LT(norm(x), 1 + 1e-8);
    if (report.time < 0.3) {
      was_slack = true;
      EXPECT_NEAR(x.x, report.time, 1e-9);
      EXPECT_NEAR(norm(system.joints().state(rope).force), 0, 1e-9);
    }
    if (norm(x) > 1 - 1e-7) was_taut = was_taut || norm(system.joints().state(rope).force) > 1;
  });
  EXPECT_TRUE(was_slack && was_taut);
}

TEST(Rope, can_be_hauled_in) {
  System system;
  const BodyId anchor = system.bodies().create({.kind = BodyKind::static_}), ball = system.bodies().create();
  const ParticleId p = system.particles().create(anchor, {0, 0, 0}), q = system.particles().create(ball, {0, -1, 0});
  const ConstraintId rope =
      system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = p, .q = q, .length = 1});
  for (int i = 0; i < 100; ++i) {
    system.joints().set_length(rope, 1 - 0.005 * i);
    (void)system.step(0.01);
  }
  EXPECT_NEAR(system.particles().position(q).y, -0.505, 1e-3);
}

TEST(Rope, that_is_hauled_moves_what_hangs_on_it_at_its_speed) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust,
                                     IntegrationMode::plausible, IntegrationMode::accurate})
    for (const ConstraintKind kind : {ConstraintKind::rope, ConstraintKind::rod}) {
      System system(SystemOptions{.mode = mode});
      const BodyId anchor = system.bodies().create({.kind = BodyKind::static_}), ball = system.bodies().create();
      const ParticleId p = system.particles().create(anchor, {}), q = system.particles().create(ball, {0, -1, 0}, 2);
      const ConstraintId line = system.joints().create(DistanceSpec{.kind = kind, .p = p, .q = q});
      (void)system.step(0.01);
      for (int i = 1; i <= 50; ++i) {
        system.joints().set_length(line, 1 - 0.005 * i);
        (void)system.step(0.01);
        ASSERT_NEAR(system.particles().velocity(q).y, 0.5, 1e-9) << i;
        if (i > 1) ASSERT_NEAR(norm(system.joints().state(line).force), 2 * g, 1e-6) << i;
      }
      EXPECT_NEAR(system.energy().external_work, 2 * g * 0.25 + 0.25, 1e-6);
      EXPECT_NEAR(system.energy().balance(), 0, 1e-9);
    }
}

TEST(Motor, reaches_its_speed_and_a_weak_one_stalls) {
  for (const double strength : {100.0, 0.5}) {
    System system;
    const BodyId block = make_block(system, {0.5, 0, 0}, {0.2, 0.2, 0.2}, 1);
    const ConstraintId joint = system.joints().create(
        JointSpec{.kind = ConstraintKind::revolute,
                  .a = block,
                  .axis = {0, 0, 1},
                  .angle = {.motor_speed = 2, .motor_max = strength, .friction = strength < 1 ? 5.0 : 0}});
    run(system, 2, 1.0 / 240);
    const ConstraintState state = system.joints().state(joint);
    if (strength > 1) {
      EXPECT_NEAR(state.speed[0], 2, 1e-4);
      EXPECT_NEAR(state.coordinate[0], 4, 0.02);
    } else {  // 0.5 + 5 N m of friction hold 0.5 * g = 4.9 N m: it does not move
      EXPECT_NEAR(state.coordinate[0], 0, 1e-6);
      EXPECT_NEAR(state.effort[0].total(), 0.5 * g, 1e-3);
    }
  }
}

TEST(Motor, a_strong_one_does_not_ring_about_its_speed) {
  System system;  // energy keeping
  const BodyId block = make_block(system, {0.5, 0, 0}, {0.2, 0.2, 0.2}, 1);
  const ConstraintId joint = system.joints().create(JointSpec{
      .kind = ConstraintKind::revolute, .a = block, .axis = {0, 0, 1}, .angle = {.motor_speed = 3, .motor_max = 1e4}});
  int step = 0;
  run(system, 1, 1.0 / 120, [&](const StepReport&) {
    if (++step == 60)
      system.joints().set_coordinate(joint, JointCoordinate::angle, {.motor_speed = -2, .motor_max = 1e4});
    EXPECT_NEAR(system.joints().state(joint).speed[0], step <= 60 ? 3 : -2, 0.01) << step;
  });
}

TEST(Limit, stops_a_swinging_block) {
  System system;
  const BodyId block = make_block(system, {0.5, 0, 0}, {0.2, 0.2, 0.2}, 1);
  const ConstraintId joint = system.joints().create(JointSpec{
      .kind = ConstraintKind::revolute, .a = block, .axis = {0, 0, 1}, .angle = {.lower = -0.7, .upper = 0.3}});
  run(system, 2, 1.0 / 240, [&](const StepReport&) {
    EXPECT_GT(system.joints().state(joint).coordinate[0], -0.7 - 1e-7);
    EXPECT_LT(system.joints().state(joint).coordinate[0], 0.3 + 1e-7);
  });
  EXPECT_NEAR(system.joints().state(joint).coordinate[0], -0.7, 1e-6);
  EXPECT_NEAR(system.joints().state(joint).effort[0].total(), 0.5 * g * std::cos(0.7), 1e-3);
}

TEST(Friction, a_block_on_an_incline_sticks_below_the_threshold_and_slides_above) {
  for (const double friction : {12.0, 6.0}) {
    System system;
    const double slope = 0.5;  // m g sin = 9.4 N
    const BodyId block = make_block(system, {0, 0, 0}, {0.2, 0.1, 0.3}, 2);
    const ConstraintId joint = system.joints().create(JointSpec{.kind = ConstraintKind::prismatic,
                                                                .a = block,
                                                                .at = {},
                                                                .axis = {std::cos(slope), -std::sin(slope), 0},
                                                                .slide = {.friction = friction}});
    run(system, 1, 1.0 / 240);
    const double pull = 2 * g * std::sin(slope);
    EXPECT_NEAR(system.joints().state(joint).speed[1], friction > pull ? 0 : (pull - friction) / 2, 1e-5);
  }
}

TEST(Spring, a_torsion_spring_has_its_period) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId block = make_block(system, {0, 0, 0}, {0.2, 0.4, 0.3}, 2);
  const double inertia = 2 * (0.2 * 0.2 + 0.4 * 0.4) / 4, stiffness = 5;
  const ConstraintId joint = system.joints().create(JointSpec{
      .kind = ConstraintKind::revolute, .a = block, .axis = {0, 0, 1}, .angle = {.stiffness = stiffness, .rest = 0.3}});
  const double omega = std::sqrt(stiffness / inertia);
  run(system, 2, 1e-3, [&](const StepReport& report) {
    EXPECT_NEAR(system.joints().state(joint).coordinate[0], 0.3 - 0.3 * std::cos(omega * report.time), 1e-3);
  });
}

std::vector<Vec3> circle(double radius, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back({radius * std::sin(2 * pi * i / count), -radius * std::cos(2 * pi * i / count), 0});
  return points;
}

TEST(Path, a_bead_on_a_vertical_circle_is_a_pendulum) {
  System system;
  const BodyId bead = system.bodies().create();
  const double amplitude = 0.2;
  const ParticleId p = system.particles().create(bead, {std::sin(amplitude), -std::cos(amplitude), 0}, 0.5);
  const ConstraintId path = system.joints().create(PathSpec{.particle = p, .points = circle(1, 64), .closed = true});
  const double period = 2 * pi / std::sqrt(g) * (1 + amplitude * amplitude / 16);
  double last = amplitude, crossings = 0, first = 0, latest = 0;
  run(system, 8, 1e-3, [&](const StepReport& report) {
    const Vec3 x = system.particles().position(p);
    EXPECT_NEAR(norm(x), 1, 1e-6) << "as round as the spline through 64 points";
    if (last < 0 && x.x >= 0) {
      latest = report.time - 1e-3 * x.x / (x.x - last);
      if (++crossings == 1) first = latest;
    }
    last = x.x;
  });
  ASSERT_GT(crossings, 2);
  EXPECT_NEAR((latest - first) / (crossings - 1), period, 2e-4 * period);
  const ConstraintState state = system.joints().state(path);
  const Vec3 x = system.particles().position(p), v = system.particles().velocity(p);
  EXPECT_NEAR(norm(state.force), 0.5 * (g * -x.y + dot(v, v)), 0.02) << "normal force";
  EXPECT_NEAR(std::abs(state.speed[1]), norm(v), 1e-5);
}

TEST(Path, a_bead_on_a_parabola_keeps_its_energy_and_stops_at_its_end) {
  System system;
  std::vector<Vec3> points;
  for (int i = -10; i <= 10; ++i) points.push_back({0.1 * i, 0.01 * i * i, 0.2});
  const BodyId bead = system.bodies().create();
  const ParticleId p = system.particles().create(bead, {-0.5, 0.25, 0.2}, 2);
  const ConstraintId path = system.joints().create(PathSpec{.particle = p, .points = points});
  run(system, 2, 1.0 / 240, [&](const StepReport& report) {
    const Vec3 x = system.particles().position(p);
    EXPECT_NEAR(x.y, x.x * x.x, 2e-3);
    EXPECT_NEAR(report.energy.total(), 2 * g * 0.25, 5e-3);
  });
  EXPECT_GT(system.joints().state(path).coordinate[1], 0);
  system.particles().set_velocity(p, {20, 0, 0});
  run(system, 1, 1.0 / 240, [&](const StepReport&) { EXPECT_LT(system.particles().position(p).x, 1 + 1e-6); });
}

TEST(Path, a_corner_of_a_polyline_is_no_hiccup) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0.5, 0, 0}, 1, {2, 0, 0});
  system.joints().create(PathSpec{.particle = p,
                                  .curve = CurveKind::polyline,
                                  .points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                  .closed = true});
  run(system, 5, 1.0 / 120, [&](const StepReport& report) {
    EXPECT_EQ(report.fallbacks, 0);
    EXPECT_NEAR(norm(system.particles().velocity(p)), 2, 0.02);
  });
}

TEST(Path, moves_with_its_body_and_pushes_it) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId rail = make_block(system, {0, 0, 0}, {2, 0.1, 0.1}, 3);
  const ParticleId p = system.particles().create(system.bodies().create(), {-1, 0, 0}, 1, {1, 0.5, 0.2});
  const ConstraintId path = system.joints().create(PathSpec{.particle = p,
                                                            .body = rail,
                                                            .points = {{-1, 0, 0}, {0, 0.1, 0}, {1, 0, 0}},
                                                            .slide = {.motor_speed = 1, .motor_max = 0.1}});
  const Vec3 momentum = system.momentum(), spin = system.angular_momentum();
  run(system, 1, 1.0 / 120, [&](const StepReport&) { EXPECT_LT(system.joints().state(path).gap, 1e-8); });
  EXPECT_NEAR(norm(system.momentum() - momentum), 0, 1e-10);
  EXPECT_NEAR(norm(system.angular_momentum() - spin), 0, 1e-10);
}

/// A bead that turns `speed` rad/s on an ellipse of wire, which is upright on a turntable on an axle of the world.
struct BeadOnTurntable {
  System system{SystemOptions{.gravity = {}}};
  BodyId table = make_block(system, {}, {0.1, 0.2, 0.3}, 2);
  ParticleId bead;

  explicit BeadOnTurntable(double speed) {
    const auto place = [](double u) { return Vec3{std::sin(u), -0.6 * std::cos(u), 0}; };
    const Vec3 turning{0, 3, 0}, start = place(0.3);
    system.bodies().set_angular_velocity(table, turning);
    system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = table, .at = {}, .axis = {0, 1, 0}});
    bead = system.particles().create(system.bodies().create(), start, 1,
                                     speed * Vec3{std::cos(0.3), 0.6 * std::sin(0.3), 0} + cross(turning, start));
    std::vector<Vec3> wire;
    for (int i = 0; i < 64; ++i) wire.push_back(place(2 * pi * i / 64));
    system.joints().create(PathSpec{.particle = bead, .body = table, .points = wire, .closed = true});
  }
};

TEST(Path, on_a_turntable_keeps_the_angular_momentum_about_its_axle) {
  for (const double speed : {2.0, 20.0}) {
    BeadOnTurntable scene(speed);
    System& system = scene.system;
    const double spin = system.angular_momentum().y;
    const StepReport first = system.step(1.0 / 60);
    const double energy = first.energy.kinetic;
    for (int i = 0; i < 120; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_NEAR(system.angular_momentum().y, spin, 1e-8 * spin) << speed << ", step " << i;
      ASSERT_NEAR(report.energy.kinetic, energy, 1e-9 * energy) << speed << ", step " << i;
    }
  }
}

TEST(Revolute, a_spring_on_a_turntable_passes_its_torque_on) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId table = make_block(system, {}, {1, 0.2, 0.6}, 2);
  const BodyId wheel = make_block(system, {0.7, 0, 0}, {0.4, 0.2, 0.3}, 1);
  system.bodies().set_angular_velocity(wheel, {0, -10, 0});
  system.joints().create(JointSpec{.kind = ConstraintKind::revolute, .a = table, .at = {}, .axis = {0, 1, 0}});
  JointSpec hinge{.kind = ConstraintKind::revolute, .a = table, .b = wheel, .at = {0.7, 0, 0}, .axis = {0, 1, 0}};
  hinge.angle.stiffness = 5;
  system.joints().create(hinge);
  const double spin = system.angular_momentum().y;
  double most = 0;
  run(system, 2, 1.0 / 60,
      [&](const StepReport&) { most = std::max(most, std::abs(system.angular_momentum().y - spin)); });
  EXPECT_LT(most, 1e-3 * std::abs(spin)) << "where all turn alike nothing else has the energy of a correction";
}

TEST(Prismatic, a_car_on_its_guide_keeps_its_momentum_while_an_arm_spins_on_it) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId car = make_block(system, {}, {1, 0.2, 0.6}, 2, {1, 0, 0});
  const BodyId arm = make_block(system, {0.7, 0, 0}, {0.4, 0.2, 0.3}, 1, {1, 0, 0});
  system.bodies().set_angular_velocity(arm, {0, 0, 10});
  system.joints().create(JointSpec{.kind = ConstraintKind::prismatic, .a = car, .at = {}, .axis = {1, 0, 0}});
  system.joints().create(
      JointSpec{.kind = ConstraintKind::revolute, .a = car, .b = arm, .at = {0.5, 0, 0}, .axis = {0, 0, 1}});
  (void)system.step(1.0 / 60);
  const double start = system.momentum().x;
  run(system, 2, 1.0 / 60, [&](const StepReport&) { ASSERT_NEAR(system.momentum().x, start, 1e-9); });
}

TEST(Surface, a_point_on_a_sphere_is_a_spherical_pendulum) {
  System system;
  const double polar = 0.8, speed = std::sqrt(g * std::sin(polar) * std::tan(polar));  // a conical one
  const ParticleId p =
      system.particles().create(system.bodies().create(), {std::sin(polar), -std::cos(polar), 0}, 1, {0, 0, speed});
  system.joints().create(SurfaceSpec{.particle = p, .surface = {Sphere{1}, {}, {}}});
  run(system, 4, 1.0 / 240, [&](const StepReport&) {
    EXPECT_NEAR(norm(system.particles().position(p)), 1, 1e-8);
    EXPECT_NEAR(system.particles().position(p).y, -std::cos(polar), 2e-4);
  });
}

TEST(Surface, every_shape_holds_a_point_where_it_says) {
  const struct {
    std::variant<Shape, SurfaceFunction> shape;
    Vec3 on;  // in the shape's frame
  } cases[] = {{HalfSpace{{0, 0, 1}}, {3, 2, 0}},
               {Sphere{0.5}, {0, 0.5, 0}},
               {Ellipsoid{{2, 4, 6}}, {0, 0, 3}},
               {Box{{2, 4, 6}, 0.2}, {0.1, 0.2, 3}},
               {Cylinder{0.5, 1, 0.1}, {0.3, 0, 0.5}},
               {Capsule{0.5, 1}, {1, 0, 0}},
               {Torus{1, 0.25}, {0, 1.25, 0}},
               {SurfaceFunction{[](const Vec3& r) { return r.y - r.x * r.x; }}, {1, 1, 0}}};
  const Quaternion turn{0, 0, std::sin(0.3), std::cos(0.3)};  // by 0.6 about z
  for (const auto& [shape, on] : cases) {
    System system{SystemOptions{.gravity = {}}};
    const Vec3 at{1, 2, 3};
    const Vec3 x{std::cos(0.6) * on.x - std::sin(0.6) * on.y, std::sin(0.6) * on.x + std::cos(0.6) * on.y, on.z};
    const ParticleId p = system.particles().create(system.bodies().create(), at + x);
    const ConstraintId c = system.joints().create(SurfaceSpec{.particle = p, .surface = {shape, at, turn}});
    run(system, 0.1, 1.0 / 60);
    EXPECT_LT(system.joints().state(c).gap, 1e-9) << shape.index();
    EXPECT_NEAR(norm(system.particles().position(p) - at - x), 0, 1e-6) << shape.index() << ": it was there already";
  }
}

TEST(Surface, with_sharp_edges_keeps_a_point_on_one_side_only) {
  for (const Shape& shape : {Shape{Box{}}, Shape{Cylinder{}}, Shape{Cone{}}}) {
    System system{SystemOptions{.gravity = {}}};
    const ParticleId p = system.particles().create(system.bodies().create(), {-0.2, 0, 0}, 1, {1.3, 0.4, 0.7});
    EXPECT_THROW(system.joints().create(SurfaceSpec{.particle = p, .surface = {shape, {}, {}}}), std::invalid_argument);
    system.joints().create(SurfaceSpec{.kind = ConstraintKind::inside, .particle = p, .surface = {shape, {}, {}}});
    const double start = system.energy().kinetic;
    for (int i = 0; i < 300; ++i) {
      (void)system.step(0.01);
      ASSERT_LE(system.energy().kinetic, start * (1 + 1e-9));
      const Vec3 x = system.particles().position(p);
      ASSERT_LE(std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}), 0.5 + 1e-6);
    }
  }
}

TEST(Inside, a_ball_in_a_bowl_falls_meets_it_without_bouncing_and_slides_to_rest_at_the_bottom) {
  System system{SystemOptions{.damping = 0.5}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0.5, 0, 0});
  const ConstraintId bowl = system.joints().create(
      SurfaceSpec{.kind = ConstraintKind::inside, .particle = p, .surface = {Sphere{1}, {}, {}}});
  const double fall = std::sqrt(2 * std::sqrt(0.75) / g);
  run(system, 20, 1.0 / 120, [&](const StepReport& report) {
    EXPECT_LT(norm(system.particles().position(p)), 1 + 1e-7);
    if (report.time < 0.9 * fall) {
      EXPECT_NEAR(system.particles().position(p).x, 0.5, 1e-9);
    }
    if (report.time > 1.1 * fall && report.time < 3 * fall) {
      const Vec3 x = system.particles().position(p);
      EXPECT_GT(norm(x), 0.99) << "no bounce";
    }
  });
  EXPECT_NEAR(system.particles().position(p).y, -1, 1e-3);
  EXPECT_NEAR(system.joints().state(bowl).force.y, g, 1e-2);
}

TEST(Outside, a_point_rolls_off_a_ball_where_it_should) {
  // It leaves a smooth sphere at a third of the radius down.
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0.02, std::sqrt(1 - 4e-4), 0});
  const ConstraintId ball = system.joints().create(
      SurfaceSpec{.kind = ConstraintKind::outside, .particle = p, .surface = {Sphere{1}, {}, {}}});
  double left_at = 0;
  run(system, 2, 1e-3, [&](const StepReport&) {
    EXPECT_GT(norm(system.particles().position(p)), 1 - 1e-8);
    if (left_at == 0 && norm(system.joints().state(ball).force) == 0 && system.particles().velocity(p).y < -0.1)
      left_at = system.particles().position(p).y;
  });
  EXPECT_NEAR(left_at, 2.0 / 3, 0.01);
}

TEST(SurfacePair, a_ball_rests_on_a_plane_and_another_on_it) {
  System system{SystemOptions{.damping = 1}};
  const auto ball = [&](double y) { return make_block(system, {0, y, 0}, {0.3, 0.3, 0.3}, 1); };
  const BodyId lower = ball(0.6), upper = ball(1.7);
  const ConstraintId floor = system.joints().create(SurfacePairSpec{
      .a = lower, .b = {}, .surface_a = {Sphere{0.5}, {0, 0.6, 0}, {}}, .surface_b = {HalfSpace{}, {}, {}}});
  const ConstraintId pair = system.joints().create(SurfacePairSpec{.a = upper,
                                                                   .b = lower,
                                                                   .surface_a = {Sphere{0.5}, {0, 1.7, 0}, {}},
                                                                   .surface_b = {Sphere{0.5}, {0, 0.6, 0}, {}}});
  run(system, 4, 1.0 / 120);
  EXPECT_NEAR(system.bodies().center_of_mass(lower).y, 0.5, 1e-6);
  EXPECT_NEAR(system.bodies().center_of_mass(upper).y, 1.5, 1e-6);
  EXPECT_NEAR(system.joints().state(floor).force.y, 2 * g, 1e-4);
  EXPECT_NEAR(system.joints().state(pair).force.y, g, 1e-4);
}

TEST(SurfacePair, a_ball_held_to_a_slope_slides_down_it) {
  System system;
  const BodyId ball = make_block(system, {0, 0.5, 0}, {0.3, 0.3, 0.3}, 1);
  const double slope = 0.4;
  const ConstraintId pair = system.joints().create(
      SurfacePairSpec{.kind = ConstraintKind::touching,
                      .a = ball,
                      .b = {},
                      .surface_a = {Sphere{0.5}, {0, 0.5, 0}, {}},
                      .surface_b = {HalfSpace{{std::sin(slope), std::cos(slope), 0}}, {0, 0, 0}, {}}});
  run(system, 1, 1.0 / 240, [&](const StepReport&) { EXPECT_LT(system.joints().state(pair).gap, 1e-8); });
  EXPECT_NEAR(norm(system.momentum()), g * std::sin(slope), 0.01);
  EXPECT_NEAR(norm(system.joints().state(pair).force), g * std::cos(slope), 1e-3);
}

TEST(Markers, of_a_joint_that_were_put_to_use_outlive_it) {
  System system;
  const BodyId block = make_block(system, {}, {1, 1, 1}, 8);
  const ConstraintId joint = system.joints().create(JointSpec{.a = block, .at = {}});
  const auto markers = system.joints().particles(joint);
  ASSERT_EQ(markers.size(), 3u);
  (void)system.edits().combine(markers[1], system.bodies().particles(block)[0]);  // it has a mass now
  system.particles().nail(markers[2]);
  system.joints().destroy(joint);
  EXPECT_FALSE(system.particles().contains(markers[0]));
  EXPECT_TRUE(system.particles().contains(markers[1]) && system.particles().contains(markers[2]));
  EXPECT_NEAR(system.bodies().mass(block), 8, 1e-12);
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}

TEST(Break, a_rope_snaps_when_its_load_is_too_much_and_the_report_names_it) {
  System system;
  const BodyId anchor = system.bodies().create({.kind = BodyKind::static_}), ball = system.bodies().create();
  const ParticleId p = system.particles().create(anchor, {}), q = system.particles().create(ball, {0, -1, 0}, 2);
  const ConstraintId rope =
      system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = p, .q = q, .breaks = {.force = 2.1 * g}});
  run(system, 0.5, 1.0 / 120, [&](const StepReport& report) { EXPECT_TRUE(report.broken.empty()); });
  system.particles().apply_force(q, {0, -0.9, 0});
  EXPECT_TRUE(system.step(1.0 / 120).broken.empty());
  system.particles().apply_force(q, {0, -4, 0});
  const StepReport report = system.step(1.0 / 120);
  ASSERT_EQ(report.broken.size(), 1u);
  EXPECT_EQ(report.broken[0].constraint, rope);
  EXPECT_NEAR(report.broken[0].force, 2 * g + 4, 1e-6);
  EXPECT_TRUE(system.joints().state(rope).broken);
  run(system, 0.5, 1.0 / 120);
  EXPECT_LT(system.particles().position(q).y, -2);
  system.joints().set_length(rope, 3), system.joints().set_active(rope, true);
  run(system, 2, 1.0 / 120);
  EXPECT_FALSE(system.joints().state(rope).broken && norm(system.particles().position(q)) < 3.1)
      << "it holds again, or snaps again";
}

TEST(Break, a_weld_gives_way_to_a_moment) {
  System system;
  const BodyId beam = make_block(system, {0.5, 0, 0}, {1, 0.1, 0.1}, 1);
  const ConstraintId weld = system.joints().create(
      JointSpec{.kind = ConstraintKind::weld, .a = beam, .at = {}, .breaks = {.torque = 0.6 * g}});
  EXPECT_TRUE(system.step(1.0 / 120).broken.empty());
  for (int i = 0; i < 10; ++i) (void)system.step(1.0 / 120);
  ASSERT_FALSE(system.joints().state(weld).broken);
  system.particles().set_mass(system.bodies().particles(beam)[7], 1);  // 0.625 kg m more
  int broken = 0;
  for (int i = 0; i < 10; ++i) broken += static_cast<int>(system.step(1.0 / 120).broken.size());
  EXPECT_EQ(broken, 1);
  EXPECT_FALSE(system.joints().state(weld).active);
}

TEST(HingeForce, of_a_hanging_chain_is_the_weight_below_it) {
  for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping})
    for (const bool by_field : {false, true}) {
      System system{SystemOptions{.mode = mode, .damping = 5}};
      const auto chain = scenes::make_chain(system, {.links = 5, .link_mass = 0.4, .direction = {0, -1, 0}});
      if (by_field)
        system.fields().create("uniform", {.parameters = {{"acceleration_y", -g}}, .replaces_gravity = true});
      for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 120);
      for (std::size_t i = 0; i < 5; ++i) {
        const double below = 0.4 * g * static_cast<double>(5 - i);
        EXPECT_NEAR(norm(system.particles().hinge_force(chain.upper[i]) - Vec3{0, below, 0}), 0, 1e-6) << i;
        EXPECT_NEAR(norm(system.particles().hinge_force(chain.lower[i]) - Vec3{0, -(below - 0.4 * g), 0}), 0, 1e-6)
            << i;
      }
    }
}

TEST(HingeForce, of_bodies_in_flight_is_what_their_motion_takes) {
  // Two blocks, hinged at a carried point of each, tumble freely: the hinge gives each what gravity does not.
  System system{SystemOptions{.gravity = {0, -3, 0}}};
  const BodyId a = make_block(system, {-0.5, 0, 0}, {0.8, 0.2, 0.3}, 1, {0, 1, 0});
  const BodyId b = make_block(system, {0.5, 0, 0}, {0.8, 0.3, 0.2}, 2, {0, 0, 1});
  const ParticleId p = system.particles().create(a, {0, 0, 0}, 0), q = system.particles().create(b, {0, 0, 0}, 0.2);
  (void)system.edits().combine(p, q);
  (void)system.step(1e-3);
  for (int i = 0; i < 300; ++i) {
    const Vec3 before_a = system.bodies().velocity(a), before_b = system.bodies().velocity(b);
    (void)system.step(1e-3);
    const Vec3 needs_a = system.bodies().mass(a) * (1e3 * (system.bodies().velocity(a) - before_a) - Vec3{0, -3, 0});
    const Vec3 needs_b = system.bodies().mass(b) * (1e3 * (system.bodies().velocity(b) - before_b) - Vec3{0, -3, 0});
    ASSERT_NEAR(norm(system.particles().hinge_force(p) - needs_a), 0, 1e-3 * (0.1 + norm(needs_a))) << i;
    ASSERT_NEAR(norm(system.particles().hinge_force(q) - needs_b), 0, 1e-3 * (0.1 + norm(needs_b))) << i;
  }
}

TEST(HingeForce, tells_springs_and_constraints_from_hinges) {
  System system{SystemOptions{.mode = IntegrationMode::robust, .damping = 20}};
  const BodyId upper = make_block(system, {0, 1, 0}, {0.2, 1, 0.2}, 1);
  const BodyId lower = make_block(system, {0, 0, 0}, {0.2, 1, 0.2}, 3);
  const ParticleId p = system.particles().create(upper, {0, 0.5, 0}, 0),
                   q = system.particles().create(lower, {0, 0.5, 0}, 0);
  system.joints().create(JointSpec{.kind = ConstraintKind::weld, .a = upper, .at = {0, 1.5, 0}});
  (void)system.edits().combine(p, q);
  const ParticleId hook = system.particles().create(system.bodies().create({.kind = BodyKind::static_}), {0, 2, 0});
  system.bonds().create(q, hook, SpringLaw{.stiffness = 10, .length = 0.5});  // pulls q up with 10 N
  for (int i = 0; i < 240; ++i) (void)system.step(1.0 / 120);
  EXPECT_NEAR(norm(system.particles().hinge_force(q) - Vec3{0, 3 * g - 10, 0}), 0, 1e-4);
  EXPECT_NEAR(norm(system.particles().hinge_force(p) + Vec3{0, 3 * g - 10, 0}), 0, 1e-4);
}

TEST(Break, a_hinge_and_a_nail_give_way_to_their_loads) {
  System system{SystemOptions{.damping = 5}};
  const auto chain = scenes::make_chain(system, {.links = 4, .link_mass = 1, .direction = {0, -1, 0}});
  system.particles().set_break_force(chain.upper[2], 2.5 * g);
  system.particles().set_break_force(chain.upper[0], 2.5 * g);
  const StepReport report = system.step(1.0 / 120);
  ASSERT_EQ(report.broken.size(), 1u) << "the nail bears 4 g; below it nothing is overloaded";
  EXPECT_EQ(report.broken[0].particle, chain.upper[0]);
  EXPECT_FALSE(system.particles().is_nailed(chain.upper[0]));
  system.particles().nail(chain.upper[0]), system.particles().set_break_force(chain.upper[0], 100 * g);
  for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 120);
  system.particles().apply_force(chain.lower[3], {0, -2 * g, 0});
  const StepReport torn = system.step(1.0 / 120);
  ASSERT_EQ(torn.broken.size(), 1u);
  EXPECT_EQ(torn.broken[0].particle, chain.upper[2]);
  EXPECT_EQ(system.particles().ring(chain.upper[2]).size(), 1u);
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iota
