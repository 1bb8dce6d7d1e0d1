// SPDX-License-Identifier: Apache-2.0
// Bodies that go further in a step than they are long, judged from places, velocities, momenta and energies.
#include "math/mat3.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace iota {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double number(double from, double to) { return std::uniform_real_distribution<>(from, to)(random_); }
  double decade(double from, double to) { return std::exp(number(std::log(from), std::log(to))); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Quaternion turn() { return normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)}); }

 private:
  std::mt19937 random_;
};

constexpr int kinds = 6;
BodyId create(System& system, int kind, double size, const SolidOptions& options) {
  switch (kind) {
    case 0: return system.bodies().create(Sphere{size}, options);
    case 1: return system.bodies().create(Box{{2 * size, 1.6 * size, 1.2 * size}}, options);
    case 2: return system.bodies().create(Capsule{0.5 * size, size}, options);
    case 3: return system.bodies().create(Cylinder{0.6 * size, 1.5 * size}, options);
    case 4: return system.bodies().create(Box{{1.8 * size, 1.8 * size, 0.1 * size}}, options);
    default: return system.bodies().create(Cylinder{0.1 * size, 1.9 * size}, options);
  }
}

/// A thing that is shot at a wall of edge 1 and some thickness, in the plane z = 0 of its frame.
struct Shot {
  double size, thickness, speed, hz;
  Vec3 place;
  Quaternion turn;
  Vec3 way;     ///< of the shot, in the frame of the wall
  Vec3 target;  ///< in the frame of the wall
};
Shot random_shot(Random& random) {
  Shot shot{random.decade(0.02, 0.15),
            random.decade(0.005, 0.1),
            random.decade(1, 300),
            random.number(0, 1) < 0.5 ? 60.0 : 120.0,
            random.vector(3),
            random.turn(),
            {},
            {}};
  shot.way = random.vector(1), shot.way.z = shot.way.z < 0 ? -1 : 1, shot.way = (1 / norm(shot.way)) * shot.way;
  shot.target = {random.number(-0.35, 0.35), random.number(-0.35, 0.35), 0};
  return shot;
}

TEST(FastBodies, do_not_get_through_walls_and_make_no_energy) {
  constexpr int shots = 300;
  for (const double e : {0.0, 1.0}) {
    int behind = 0, hits = 0;
    for (int i = 0; i < shots; ++i) {
      Random random(1000 + i);
      const Shot shot = random_shot(random);
      System system({.gravity = {}});
      system.set_mode(i % 5 == 0 ? IntegrationMode::robust : IntegrationMode::energy_keeping);
      const Material material{.friction = random.number(0, 1), .restitution = e};
      system.set_usual_material(material);
      const BodyId wall = system.bodies().create_obstacle(Box{{1, 1, shot.thickness}}, shot.place, shot.turn);
      system.bodies().set_material(wall, material);
      const Vec3 way = rotate(shot.turn, shot.way), target = shot.place + rotate(shot.turn, shot.target);
      const double distance = 1 + random.number(0, 1) * shot.speed / shot.hz;
      const BodyId body = create(system, i % kinds, shot.size,
                                 {.position = target - distance * way,
                                  .orientation = random.turn(),
                                  .velocity = shot.speed * way,
                                  .spin = random.vector(i % 2 == 0 ? 0 : 20)});
      const auto in_frame = [&] {
        return rotate(conjugate(shot.turn), system.bodies().center_of_mass(body) - shot.place);
      };
      const double before = system.energy().kinetic;
      const int steps = static_cast<int>((distance + 0.3) / shot.speed * shot.hz) + 3;
      for (int k = 0; k < steps; ++k) {
        const Vec3 from = in_frame();
        // What turns ten times in a step may be given up: its points were mirrored before, which passed for solved.
        const bool whirls = norm(system.bodies().angular_velocity(body)) > 60 * shot.hz;
        EXPECT_LE(system.step(1 / shot.hz).unconverged, whirls ? 1 : 0) << i;
        const Vec3 to = in_frame();
        EXPECT_LE(system.energy().kinetic, before * (1 + 1e-9)) << i;
        behind += from.z * to.z < 0 && from.z * shot.way.z < 0 && std::max(std::abs(to.x), std::abs(to.y)) < 0.5;
      }
      hits += norm(system.bodies().velocity(body) - shot.speed * way) > 1e-3 * shot.speed;
    }
    EXPECT_EQ(hits, shots);
    EXPECT_LE(behind, 2) << "restitution " << e;  // some hundred thicknesses a step
  }
}

TEST(FastBodies, that_bounce_off_a_wall_do_not_get_through_what_is_behind_them) {
  for (const auto mode : {IntegrationMode::energy_keeping, IntegrationMode::robust, IntegrationMode::accurate})
    for (const double speed : {10, 20, 40, 60})
      for (const double gap : {0.005, 0.05, 0.2}) {
        System system({.gravity = {}});
        system.set_mode(mode);
        system.set_usual_material(Material{.friction = 0, .restitution = 0.9});
        (void)system.bodies().create_obstacle(Box{{0.1, 2, 2}}, {0.15, 0, 0}, {});
        const BodyId plate =
            system.bodies().create(Box{{0.03, 1, 1}}, {.density = 160, .position = {-0.065 - gap, 0, 0}});
        const BodyId ball = system.bodies().create(Sphere{0.05}, {.density = 2000, .velocity = {speed, 0, 0}});
        for (int k = 0; k < 6; ++k) {
          EXPECT_EQ(system.step(1.0 / 60).unconverged, 0);
          EXPECT_GT(system.bodies().center_of_mass(ball).x, system.bodies().center_of_mass(plate).x)
              << speed << ' ' << gap;
        }
      }
}

TEST(FastBodies, that_are_struck_meet_what_is_beside_them_in_the_same_step) {
  for (const auto mode : {IntegrationMode::energy_keeping, IntegrationMode::robust})
    for (const double speed : {2, 5, 20})
      for (const double e : {0.0, 0.8}) {
        System system({.gravity = {}});
        system.set_mode(mode);
        system.set_usual_material(Material{.friction = 0, .restitution = e});
        (void)system.bodies().create_obstacle(Box{{0.03, 2, 2}}, {0.3, 0, 0}, {});
        std::vector<BodyId> row{system.bodies().create(
            Sphere{0.05}, {.density = 2000, .position = {-0.1, 0, 0}, .velocity = {speed, 0, 0}})};
        for (int i = 0; i < 5; ++i)
          row.push_back(system.bodies().create(Box{{0.01, 0.3, 0.3}}, {.density = 220, .position = {0.02 * i, 0, 0}}));
        for (int k = 0; k < 20; ++k) {
          (void)system.step(1.0 / 60);
          const auto place = [&](BodyId body) { return system.bodies().center_of_mass(body).x; };
          EXPECT_TRUE(std::ranges::is_sorted(row, {}, place)) << speed << ' ' << e << ' ' << k;
          EXPECT_LT(place(row.back()), 0.3);
        }
      }
}

TEST(FastBodies, that_fall_one_above_the_other_do_not_fall_into_each_other) {
  for (const auto mode : {IntegrationMode::energy_keeping, IntegrationMode::robust})
    for (const double speed : {3, 5, 10})
      for (const double gap : {0.001, 0.01})
        for (const double size : {0.05, 0.2}) {
          System system;
          system.set_mode(mode);
          system.set_usual_material(Material{});
          (void)system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
          std::vector<BodyId> boxes;
          for (int i = 0; i < 4; ++i)
            boxes.push_back(system.bodies().create(
                Box{{size, size, size}},
                {.density = 500, .position = {0, 0.05 + size / 2 + i * (size + gap), 0}, .velocity = {0, -speed, 0}}));
          for (int k = 0; k < 30; ++k) {
            (void)system.step(1.0 / 60);
            double below = -size / 2;
            for (const BodyId box : boxes) {
              const double height = system.bodies().center_of_mass(box).y;
              EXPECT_GT(height - below, (1 - 1e-3) * size) << speed << ' ' << gap << ' ' << size << ' ' << k;
              below = height;
            }
          }
        }
}

TEST(FastBodies, that_pass_beside_a_wall_are_not_deflected) {
  int deflected = 0;
  for (int i = 0; i < 300; ++i) {
    Random random(i);
    Shot shot = random_shot(random);
    System system({.gravity = {}});
    system.set_usual_material(Material{});
    const BodyId wall = system.bodies().create_obstacle(Box{{1, 1, shot.thickness}}, shot.place, shot.turn);
    system.bodies().set_material(wall, Material{});
    shot.target = {0.5 + 1.5 * shot.size * random.number(1.05, 1.5), random.number(-0.5, 0.5), 0};
    shot.way.x = 0;
    const Vec3 way = rotate(shot.turn, (1 / norm(shot.way)) * shot.way);
    const double distance = 1 + random.number(0, 1) * shot.speed / shot.hz;
    const BodyId body = create(system, i % kinds, shot.size,
                               {.position = shot.place + rotate(shot.turn, shot.target) - distance * way,
                                .orientation = random.turn(),
                                .velocity = shot.speed * way});
    for (double s = 0; s < 2 * distance; s += shot.speed / shot.hz) (void)system.step(1 / shot.hz);
    deflected += norm(system.bodies().velocity(body) - shot.speed * way) > 1e-6 * shot.speed;
  }
  EXPECT_LE(deflected, 2);
}

TEST(FastBodies, that_meet_in_space_keep_momentum_and_angular_momentum) {
  for (int i = 0; i < 60; ++i) {
    Random random(i);
    System system({.gravity = {}});
    system.set_usual_material(Material{.friction = random.number(0, 1), .restitution = random.number(0, 1)});
    const double size = random.decade(0.01, 1), speed = size * random.decade(100, 10000);
    const Vec3 way = rotate(random.turn(), {0, 0, 1});
    const double distance = size * random.number(5, 50);
    const BodyId first = create(system, i % kinds, size,
                                {.position = -distance * way, .orientation = random.turn(), .velocity = speed * way});
    const BodyId second = create(
        system, i / kinds % kinds, size * random.number(0.5, 2),
        {.density = 1000 * random.decade(0.1, 10), .orientation = random.turn(), .velocity = -0.8 * speed * way});
    const Vec3 linear = system.momentum(), angular = system.angular_momentum();
    const double scale = system.bodies().mass(first) * speed, before = system.energy().kinetic;
    double meet = 0;
    for (int k = 0; k < 40; ++k) {
      (void)system.step(1.0 / 120);
      meet = std::max(meet, norm(system.bodies().velocity(first) - speed * way));
    }
    EXPECT_GT(meet, 1e-4 * speed) << i;
    EXPECT_LT(norm(system.momentum() - linear), 1e-8 * scale) << i;
    EXPECT_LT(norm(system.angular_momentum() - angular), 1e-5 * scale * distance) << i;
    EXPECT_LE(system.energy().kinetic, before * (1 + 1e-9)) << i;
    (void)second;
  }
}

TEST(FastBodies, bounce_in_a_thin_box_and_stay_in_it_with_the_same_bits_for_any_number_of_threads) {
  const auto run = [](int threads, bool restores) {
    System system({.gravity = {}});
    system.set_threads(threads);
    const Material material{.friction = 0.2, .restitution = 1};
    system.set_usual_material(material);
    constexpr double half = 1, thickness = 0.01;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        Vec3 sizes{2.1, 2.1, 2.1}, place;
        (axis == 0 ? sizes.x : axis == 1 ? sizes.y : sizes.z) = thickness;
        (axis == 0 ? place.x : axis == 1 ? place.y : place.z) = sign * half;
        system.bodies().set_material(system.bodies().create_obstacle(Box{sizes}, place, {}), material);
      }
    Random random(3);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 12; ++i)
      bodies.push_back(
          create(system, i % 4, 0.06,
                 {.position = {-0.6 + 0.4 * (i % 4), -0.4 + 0.4 * (i / 4), 0}, .velocity = random.vector(60)}));
    const double before = system.energy().kinetic;
    for (int k = 0; k < 90; ++k) {
      if (k == 45) {
        const Snapshot saved = system.snapshot();
        for (int i = 0; i < 3 && restores; ++i) (void)system.step(1.0 / 60);
        if (restores) system.restore(saved);
      }
      (void)system.step(1.0 / 60);
      EXPECT_LE(system.energy().kinetic, before * (1 + 1e-9));
    }
    std::vector<Vec3> places;
    for (const BodyId body : bodies) places.push_back(system.bodies().center_of_mass(body));
    return places;
  };
  const std::vector<Vec3> places = run(1, false);
  int outside = 0;
  for (const Vec3& place : places) outside += std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) > 1;
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(places, run(4, false));
  EXPECT_EQ(places, run(1, true));
}

TEST(FastBodies, are_told_with_the_impulse_of_the_whole_step) {
  System system({.gravity = {}});
  const Material material{.friction = 0, .restitution = 0.5};
  system.set_usual_material(material);
  system.bodies().set_material(system.bodies().create_obstacle(Box{{4, 4, 0.01}}, {}, {}), material);
  const BodyId ball = system.bodies().create(Sphere{0.05}, {.position = {0, 0, 2.3}, .velocity = {0, 0, -90}});
  (void)system.contacts().watch({});
  double impulse = 0, speed = 0;
  int begins = 0;
  for (int k = 0; k < 6; ++k)
    for (const ContactEvent& event : system.step(1.0 / 60).contacts)
      if (event.began) ++begins, impulse = event.impulse, speed = event.speed;
  EXPECT_EQ(begins, 1);
  EXPECT_NEAR(speed, 90, 1e-6);
  EXPECT_NEAR(impulse, 1.5 * 90 * system.bodies().mass(ball), 1e-4 * 90 * system.bodies().mass(ball));
  EXPECT_NEAR(system.bodies().velocity(ball).z, 45, 1e-6);
}

/// The mirror image of a solid's points meets all rows between them: 28 of 400 such plates ended as theirs.
TEST(FastBodies, that_are_thin_plates_are_not_turned_inside_out_by_a_fall) {
  for (unsigned i = 0; i < 200; ++i) {
    Random random(i);
    const double hz = i % 3 == 0 ? 30 : 60;
    System system;
    system.set_mode(i % 2 == 0 ? IntegrationMode::robust : IntegrationMode::plausible);
    system.set_usual_material(Material{.friction = 0.5, .restitution = i % 4 < 2 ? 0.5 : 0});
    (void)system.bodies().create_obstacle(Box{{100, 1, 100}}, {0, -0.5, 0});
    const BodyId plate = system.bodies().create(Box{{1, random.decade(0.003, 0.03), random.number(0.2, 1)}},
                                                {.position = {0, random.number(0.5, 1.2), 0},
                                                 .orientation = random.turn(),
                                                 .velocity = random.vector(3),
                                                 .spin = random.vector(random.decade(0.03, 2) * hz)});
    const auto volume = [&] {
      const std::vector<ParticleId> points = system.bodies().particles(plate);
      const Vec3 first = system.particles().position(points[0]);
      const auto arm = [&](int k) { return system.particles().position(points[k]) - first; };
      return dot(arm(1), cross(arm(2), arm(3)));
    };
    const double before = volume();
    for (int k = 0; k < 60; ++k) (void)system.step(1 / hz);
    EXPECT_NEAR(volume() / before, 1, 1e-3) << i;
  }
}

/// The slide was measured along an axis of the screw itself: 20 m on, with a lever of 100 lengths, steps were not solved any
/// more, and it lost nine tenths of its energy in 2 s.
TEST(FastBodies, a_screw_keeps_its_speed_however_far_it_has_come) {
  for (const double lead : {-0.16, 0.4}) {
    System system({.gravity = {}, .mode = IntegrationMode::energy_keeping});
    const double speed = 2 * std::numbers::pi * 2.8 * 60, rise = lead * 2.8 * 60;
    const BodyId body =
        system.bodies().create(Box{{0.17, 0.2, 0.1}}, {.velocity = {0, 0, rise}, .spin = {0, 0, speed}});
    (void)system.joints().create({.kind = ConstraintKind::screw, .a = body, .axis = {0, 0, 1}, .lead = lead});
    (void)system.step(1.0 / 60);
    const double kinetic = system.energy().kinetic;
    int most = 0;
    for (int i = 0; i < 150; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_EQ(report.unconverged + report.fallbacks, 0) << i;
      most = std::max(most, report.iterations_max);
    }
    EXPECT_LT(most, 12);
    EXPECT_NEAR(system.energy().kinetic / kinetic, 1, 1e-8);
    EXPECT_NEAR(system.bodies().center_of_mass(body).z / (151 * rise / 60), 1, 0.05);
  }
}

}  // namespace
}  // namespace iota
