// SPDX-License-Identifier: Apache-2.0
// Balanced bodies that share two points with the rest and turn about the line through these.
#include "modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace iota {
namespace {

const Vec3 axis{0, 1, 0};

enum class Rim { of_points, of_a_cylinder };
enum class Frame { nailed, of_a_box, of_points };

struct Mounted {
  BodyId wheel, frame;
  bool has_frame;
};

/// A wheel about `axis` at the origin with spin (rad/s), hinged at two points to a frame, which turns with `turn` (rad/s).
Mounted mount(System& system, Rim rim, int points, Frame frame, double size, double mass, double spin,
              const Vec3& turn = {}) {
  const std::array hubs{Vec3{0, -0.05 * size, 0}, Vec3{0, 0.05 * size, 0}};
  const auto velocity = [&](const Vec3& at) { return cross(turn, at); };
  std::array<ParticleId, 2> ends;
  Mounted made{.wheel = {}, .frame = {}, .has_frame = frame != Frame::nailed};
  if (rim == Rim::of_a_cylinder) {
    made.wheel = system.bodies().create(Cylinder{0.3 * size, 0.1 * size},
                                        {.mass = mass, .spin = spin * axis + turn, .attachments = {hubs[0], hubs[1]}});
    const auto all = system.bodies().particles(made.wheel);
    ends = {all[4], all[5]};
  } else {
    made.wheel = system.bodies().create();
    for (const int k : {0, 1}) ends[k] = system.particles().create(made.wheel, hubs[k], 0.1 * mass, velocity(hubs[k]));
    for (int i = 0; i < points; ++i) {
      const double angle = 2 * std::numbers::pi * i / points;
      const Vec3 at = 0.3 * size * Vec3{std::cos(angle), 0, std::sin(angle)};
      system.particles().create(made.wheel, at, 0.8 / points * mass, cross(spin * axis + turn, at));
    }
  }
  if (frame == Frame::nailed)
    for (const ParticleId end : ends) system.particles().nail(end);
  if (frame == Frame::of_a_box) {
    made.frame =
        system.bodies().create(Box{size * Vec3{0.2, 0.2, 2}},
                               {.mass = 2 * mass,
                                .position = {0, 0, 0.5 * size},
                                .velocity = velocity({0, 0, 0.5 * size}),
                                .spin = turn,
                                .attachments = {{0, -0.05 * size, -0.5 * size}, {0, 0.05 * size, -0.5 * size}}});
    const auto all = system.bodies().particles(made.frame);
    for (const int k : {0, 1}) system.edits().combine(all[4 + k], ends[k]);
  }
  if (frame == Frame::of_points) {
    made.frame = system.bodies().create();
    for (const int k : {0, 1})
      system.edits().combine(system.particles().create(made.frame, hubs[k], 0.5 * mass, velocity(hubs[k])), ends[k]);
    for (const double y : {0.0, 0.2})
      system.particles().create(made.frame, size * Vec3{0, y, 1}, 0.5 * mass, velocity(size * Vec3{0, y, 1}));
  }
  return made;
}

/// Relative to the frame, about the axis.
double spin_of(const System& system, const Mounted& m) {
  Vec3 relative = system.bodies().angular_velocity(m.wheel);
  if (m.has_frame) relative += -1.0 * system.bodies().angular_velocity(m.frame);
  return dot(relative, axis);
}

}  // namespace

/// Before, 0.5 to 2.8 of 30 rad/s were left in a frame after 2 s at 60 Hz. The first steps, in which the rim's chords differ from
/// its arcs, take a part that shrinks with the square of the step.
TEST(Wheels, that_share_two_points_nearly_keep_their_spin) {
  for (const IntegrationMode mode : end_point_modes)
    for (const auto& [hertz, tolerance] : {std::pair{60, 0.04}, {240, 0.003}})
      for (const double size : {1e-6, 1.0, 1e3})
        for (const double mass : {1e-9, 1.0, 1e6})
          for (const auto& [rim, points] :
               {std::pair{Rim::of_points, 2}, {Rim::of_points, 4}, {Rim::of_points, 8}, {Rim::of_a_cylinder, 0}})
            for (const Frame frame : {Frame::nailed, Frame::of_a_box, Frame::of_points}) {
              System system{SystemOptions{.gravity = {}, .mode = mode}};
              const Mounted m = mount(system, rim, points, frame, size, mass, 30);
              const Vec3 momentum = system.momentum(), angular = system.angular_momentum();
              double energy = system.energy().total();
              for (int i = 0; i < 2 * hertz; ++i) {
                const StepReport report = system.step(1.0 / hertz);
                ASSERT_LE(report.energy.total(), energy * (1 + 1e-9));
                ASSERT_EQ(report.unconverged, 0);
                energy = report.energy.total();
              }
              const std::string scene = std::to_string(hertz) + " Hz, " + std::to_string(size) + " m, " +
                                        std::to_string(mass) + " kg, " + std::to_string(points) + " points, frame " +
                                        std::to_string(static_cast<int>(frame));
              EXPECT_NEAR(spin_of(system, m), 30, 30 * tolerance) << scene;
              EXPECT_EQ(system.energy().made, 0) << scene;
              if (frame == Frame::nailed) continue;
              EXPECT_LT(norm(system.momentum() - momentum), 1e-6 * mass * size) << scene;
              EXPECT_LT(norm(system.angular_momentum() - angular), 1e-5 * norm(angular)) << scene;
            }
}

/// Of two rim points, whose moments of inertia differ, on an axle that turns: the moment that this causes is no loss. Against
/// the accurate mode.
TEST(Wheels, on_an_axle_that_turns_follow_the_accurate_mode) {
  for (const int points : {2, 4}) {
    const auto turned = [&](IntegrationMode mode, int hertz) {
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      const Mounted m = mount(system, Rim::of_points, points, Frame::of_a_box, 1, 1, 10, {1, 0, 0.5});
      for (int i = 0; i < hertz / 2; ++i) (void)system.step(1.0 / hertz);
      return system.bodies().angular_velocity(m.wheel);
    };
    const Vec3 exact = turned(IntegrationMode::accurate, 240);
    const double coarse = norm(turned(IntegrationMode::robust, 240) - exact),
                 fine = norm(turned(IntegrationMode::robust, 960) - exact);
    EXPECT_LT(fine, 0.02 * norm(exact)) << points;
    EXPECT_LT(fine, 0.5 * coarse) << points;
  }
}

}  // namespace iota
