// SPDX-License-Identifier: Apache-2.0
// Impacts with restitution and rolling resistance, judged from places and velocities.
#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace iota {
namespace {

constexpr IntegrationMode both_modes[] = {IntegrationMode::energy_keeping, IntegrationMode::robust};

System make_hall(Material material, IntegrationMode mode = IntegrationMode::energy_keeping) {
  System system;
  system.set_mode(mode), system.set_usual_material(material);
  system.bodies().set_material(system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {}), material);
  return system;
}
BodyId drop_ball(System& system, double height, double radius) {
  return system.bodies().create(Sphere{radius}, {.position = {0, radius + height, 0}});
}
/// The height to which the ball has risen or will rise, by its place and speed.
double apex(const System& system, BodyId ball, double radius) {
  const double v = system.bodies().velocity(ball).y;
  return system.bodies().center_of_mass(ball).y - radius + v * v / (2 * g);
}
double energy_of(const System& system) { return system.energy().kinetic + system.energy().potential; }

TEST(Impacts, lift_a_ball_to_the_square_of_the_restitution_of_its_height) {
  for (const double radius : {0.01, 1.0})
    for (const double per_second : {60.0, 240.0})
      for (const double e : {0.5, 0.9, 1.0}) {
        System system = make_hall(Material{.restitution = e});
        const double height = 10 * radius;
        const BodyId ball = drop_ball(system, height, radius);
        double wanted = height;
        int bounces = 0;
        const double last = 4 * g / (per_second * per_second);  // below it impacts end
        for (int i = 0; i < 20 * std::sqrt(height) * per_second && bounces < 5 && wanted > last; ++i) {
          const double before = system.bodies().velocity(ball).y;
          (void)system.step(1 / per_second);
          ASSERT_LE(apex(system, ball, radius), wanted * (1 + 1e-12));
          if (before >= 0 || system.bodies().velocity(ball).y <= 0) continue;
          ++bounces, wanted *= e * e;
          EXPECT_NEAR(apex(system, ball, radius), wanted, 1e-6 * wanted) << radius << " m, restitution " << e;
        }
        EXPECT_GE(bounces, 2);
      }
}

TEST(Impacts, let_a_ball_bounce_as_long_as_the_sum_of_its_flights) {
  for (const double e : {0.5, 0.8}) {
    constexpr double h = 1.0 / 240, height = 0.9;
    System system = make_hall(Material{.restitution = e});
    const BodyId ball = drop_ball(system, height, 0.1);
    const double whole = std::sqrt(2 * height / g) * (1 + e) / (1 - e);
    double last = 0;
    for (int i = 1; i * h < whole + 0.5; ++i) {
      (void)system.step(h);
      if (norm(system.bodies().velocity(ball)) > 1e-6) last = i * h;
    }
    EXPECT_NEAR(last, whole, 4 * h / (1 - e));
  }
}

TEST(Impacts, of_two_balls_follow_newtons_law_at_any_ratio_of_masses) {
  for (const IntegrationMode mode : both_modes)
    for (const double ratio : {1e-3, 1.0, 1e3})
      for (const double e : {0.0, 0.5, 1.0}) {
        System system;
        system.set_mode(mode), system.set_gravity({}), system.set_usual_material(Material{.restitution = e});
        const BodyId a = system.bodies().create(Sphere{0.1}, {.position = {-0.5, 0, 0}, .velocity = {2, 0, 0}});
        const BodyId b = system.bodies().create(
            Sphere{0.1}, {.density = 1000 * ratio, .position = {0.5, 0, 0}, .velocity = {-1, 0, 0}});
        for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 120);
        const double m = system.bodies().mass(a), n = system.bodies().mass(b), impulse = (1 + e) * 3 * m * n / (m + n);
        EXPECT_LT(norm(system.bodies().velocity(a) - Vec3{2 - impulse / m, 0, 0}), 1e-7) << ratio << " " << e;
        EXPECT_LT(norm(system.bodies().velocity(b) - Vec3{-1 + impulse / n, 0, 0}), 1e-7) << ratio << " " << e;
      }
}

TEST(Impacts, beside_the_line_of_centers_keep_both_momenta) {
  for (const double e : {0.5, 1.0}) {
    System system;
    system.set_gravity({}), system.set_usual_material(Material{.friction = 0.4, .restitution = e});
    std::vector<BodyId> bodies;
    bodies.push_back(
        system.bodies().create(Box{{0.2, 0.1, 0.3}}, {.position = {-0.5, 0.03, 0}, .velocity = {3, 0, 0}}));
    bodies.push_back(system.bodies().create(Sphere{0.1}, {.position = {0.4, 0, 0.05}, .velocity = {-1, 0, 0}}));
    const Vec3 linear = system.momentum(), angular = system.angular_momentum();
    for (int i = 0; i < 120; ++i) (void)system.step(1.0 / 120);
    EXPECT_LT(norm(system.momentum() - linear), 1e-10 * norm(linear));
    EXPECT_LT(norm(system.angular_momentum() - angular), 1e-7 * norm(linear));
    EXPECT_LT(system.bodies().velocity(bodies[0]).x, system.bodies().velocity(bodies[1]).x);
  }
}

// mu times the impulse along the normal, whenever in its step it lands.
TEST(Impacts, have_the_friction_of_their_impulse_at_any_time_of_a_step) {
  constexpr double mu = 0.1, radius = 0.1, h = 1.0 / 120, speed = 2;
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::accurate})
    for (const auto& [e, part] : std::initializer_list<std::pair<double, double>>{
             {0, 0.01}, {0, 0.25}, {0, 0.5}, {0, 0.75}, {0, 0.99}, {0.5, 0.01}, {0.5, 0.6}, {1, 0.3}, {1, 0.99}}) {
      System system = make_hall(Material{.friction = mu, .restitution = e}, mode);
      system.set_gravity({});
      const BodyId ball = drop_ball(system, (3 + part) * speed * h, radius);
      system.bodies().set_velocity(ball, {3, -speed, 0});
      for (int i = 0; i < 20; ++i) {
        const StepReport report = system.step(h);
        EXPECT_EQ(report.unconverged + report.approximate, 0);
      }
      const Vec3 velocity = system.bodies().velocity(ball);
      EXPECT_NEAR(velocity.x, 3 - mu * (1 + e) * speed, 1e-7) << e << " " << part;
      EXPECT_NEAR(velocity.y, e * speed, 1e-7) << e << " " << part;
      EXPECT_NEAR(system.bodies().angular_velocity(ball).z, -2.5 * mu * (1 + e) * speed / radius, 0.01)
          << e << " " << part;
    }
}

// Balls in a row that touch, the first of which arrive from the left.
std::vector<double> speeds_of_row(const std::vector<double>& masses, std::size_t moving, double restitution,
                                  IntegrationMode mode) {
  constexpr double radius = 0.1, size = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
  System system;
  system.set_mode(mode), system.set_gravity({});
  system.set_usual_material(Material{.friction = 0.3, .restitution = restitution});
  std::vector<BodyId> row;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const double x = 2 * radius * static_cast<double>(i) - (i < moving ? 0.3 : 0);
    row.push_back(system.bodies().create(Sphere{radius}, {.density = masses[i] / size, .position = {x, 0, 0}}));
    if (i < moving) system.bodies().set_velocity(row.back(), {1, 0, 0});
  }
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 120);
  std::vector<double> speeds;
  for (const BodyId ball : row) speeds.push_back(system.bodies().velocity(ball).x);
  return speeds;
}

/// The spin of a box that fell on an edge while it turned, after the impact; lengths in m, times in units of so many s.
Vec3 spin_after_falling_on_an_edge(IntegrationMode mode, double tilt, double time) {
  System system = make_hall(Material{.friction = 0.8, .restitution = 0.5}, mode);
  system.set_gravity({0, -g / (time * time), 0});
  const double lean = std::numbers::pi / 4 + 0.3, a = std::sin(tilt / 2), b = std::cos(tilt / 2),
               c = std::sin(lean / 2), d = std::cos(lean / 2);
  const BodyId box = system.bodies().create(Box{{0.4, 0.4, 0.6}}, {.position = {0, 0.4, 0},
                                                                   .orientation = {a * d, -a * c, b * c, b * d},
                                                                   .velocity = {1 / time, -2 / time, 0},
                                                                   .spin = {1 / time, 0, 0}});
  for (int i = 0; i < 12; ++i) (void)system.step(time / 120);
  return time * system.bodies().angular_velocity(box);
}

TEST(Impacts, let_both_corners_of_an_edge_stick_though_one_of_them_is_higher_and_rebounds_faster) {
  for (const IntegrationMode mode : both_modes) {
    const auto spin_at = [&](double tilt, double time = 1) { return spin_after_falling_on_an_edge(mode, tilt, time); };
    for (const double tilt : {-0.055, -0.045}) EXPECT_LT(norm(spin_at(tilt) - spin_at(-0.05)), 0.06) << tilt;
    for (const double time : {1.0 / 64, 64.0}) EXPECT_LT(norm(spin_at(-0.045, time) - spin_at(-0.045)), 1e-6) << time;
  }
}

TEST(Impacts, pass_through_a_row_of_balls_to_as_many_at_its_end) {
  for (const IntegrationMode mode : both_modes)
    for (const std::size_t count : {3, 5, 7})
      for (std::size_t moving = 1; moving < count; ++moving) {
        const std::vector<double> speeds = speeds_of_row(std::vector<double>(count, 1.0), moving, 1, mode);
        for (std::size_t i = 0; i < count; ++i)
          EXPECT_NEAR(speeds[i], i + moving >= count ? 1 : 0, 1e-6) << moving << " of " << count << ", ball " << i;
      }
}

// Each pair in turn follows Newton's law of two balls.
TEST(Impacts, pass_through_a_row_of_heavier_and_heavier_balls_in_turn) {
  for (const double e : {0.6, 1.0}) {
    const std::vector<double> masses{1, 2, 5, 20};
    std::vector<double> wanted(masses.size(), 0.0);
    wanted[0] = 1;
    for (bool any = true; std::exchange(any, false);)
      for (std::size_t i = 0; i + 1 < masses.size(); ++i) {
        const double approach = wanted[i] - wanted[i + 1];
        if (approach < 1e-3) continue;
        const double impulse = (1 + e) * approach * masses[i] * masses[i + 1] / (masses[i] + masses[i + 1]);
        wanted[i] -= impulse / masses[i], wanted[i + 1] += impulse / masses[i + 1], any = true;
      }
    const std::vector<double> speeds = speeds_of_row(masses, 1, e, IntegrationMode::energy_keeping);
    for (std::size_t i = 0; i < masses.size(); ++i) EXPECT_NEAR(speeds[i], wanted[i], 1e-6) << e << ", ball " << i;
  }
}

// What lies on the ground bounces off it with what hits it: two balls that exchange their speeds.
TEST(Impacts, go_down_to_the_ground_and_come_back) {
  System system = make_hall(Material{.friction = 0, .restitution = 1});
  const BodyId below = drop_ball(system, 0, 0.1);
  const BodyId above = system.bodies().create(Sphere{0.1}, {.position = {0, 0.5, 0}, .velocity = {0, -2, 0}});
  const double energy = energy_of(system);
  for (int i = 0; i < 24; ++i) (void)system.step(1.0 / 120);
  EXPECT_NEAR(energy_of(system), energy, 1e-4 * energy);
  const double speed = system.bodies().velocity(above).y, height = system.bodies().center_of_mass(above).y;
  EXPECT_NEAR(0.5 * speed * speed + g * height, 0.5 * 4 + g * 0.5, 1e-2);
  EXPECT_NEAR(system.bodies().center_of_mass(below).y, 0.1, 5e-3);
}

TEST(Impacts, never_raise_the_energy) {
  std::mt19937 random(7);
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * std::uniform_real_distribution<>()(random);
  };
  const auto vector = [&](double size) {
    return Vec3{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  };
  for (int scene = 0; scene < 120; ++scene) {
    const double size = std::pow(10, uniform(-1.5, 0.5)), e = scene % 3 == 0 ? 1 : uniform(0, 1);
    const Material material{.friction = uniform(0, 1), .restitution = e, .rolling = scene % 2 * uniform(0, 0.1)};
    System system = make_hall(material, both_modes[scene % 5 == 0]);
    const int count = 1 + scene % 3;
    double weight = 0;
    for (int i = 0; i < count; ++i) {
      const double a = size * uniform(0.3, 1);
      const SolidOptions options{
          .density = std::pow(10, uniform(2, 4)),
          .position = {uniform(-1, 1) * size, (1 + 1.8 * i) * size, 0},
          .orientation = normalized(Quaternion{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), 1}),
          .velocity = vector(5 * std::sqrt(size)),
          .spin = vector(8)};
      const Shape shapes[] = {Box{{a, a * uniform(0.2, 1), a * uniform(0.2, 1)}}, Sphere{a / 2}, Capsule{a / 4, a / 2},
                              Cylinder{a / 3, a / 2}};
      weight += system.bodies().mass(system.bodies().create(shapes[random() % 4], options));
    }
    const double before = energy_of(system), unit = system.energy().kinetic + weight * g * size;
    for (int i = 0; i < 120; ++i) {
      (void)system.step(1.0 / 90);
      ASSERT_LT(energy_of(system) - before, 1e-10 * unit) << "scene " << scene << ", step " << i;
    }
  }
}

TEST(Impacts, end_where_a_body_rests) {
  for (const IntegrationMode mode : both_modes) {
    System system = make_hall(Material{.restitution = 0.9}, mode);
    system.set_rest({.after = 0.2});
    const BodyId box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
    for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 120);
    EXPECT_EQ(system.bodies().kind(box), BodyKind::resting);
    EXPECT_NEAR(system.bodies().center_of_mass(box).y, 0.1, 1e-9);
  }
}

TEST(Impacts, go_on_from_a_snapshot_bit_by_bit) {
  for (const double share : {0.3, 0.37, 0.45}) {
    System system = make_hall(Material{.restitution = 0.8, .rolling = 0.05});
    const BodyId ball = system.bodies().create(Sphere{0.1}, {.position = {0, 0.4, 0}, .velocity = {1, 0, 0}});
    for (int i = 0; i < share * 120; ++i) (void)system.step(1.0 / 120);
    System copy;
    copy.restore(system.snapshot());
    for (int i = 0; i < 120; ++i) (void)system.step(1.0 / 120), (void)copy.step(1.0 / 120);
    EXPECT_EQ(system.bodies().center_of_mass(ball), copy.bodies().center_of_mass(ball));
    EXPECT_EQ(copy.bodies().material(ball), std::nullopt);
    EXPECT_EQ(copy.usual_material(), (Material{.restitution = 0.8, .rolling = 0.05}));
  }
}

TEST(Impacts, take_the_larger_restitution_of_two) {
  System system = make_hall(Material{.restitution = 0.2});
  const BodyId ball = drop_ball(system, 0.5, 0.1);
  system.bodies().set_material(ball, Material{.restitution = 0.8});
  while (system.bodies().velocity(ball).y <= 0) (void)system.step(1.0 / 120);
  EXPECT_NEAR(apex(system, ball, 0.1), 0.64 * 0.5, 1e-6);
}

TEST(RollingResistance, stops_a_ball_after_the_way_of_its_law) {
  for (const double radius : {0.01, 1.0})
    for (const double coefficient : {0.01, 0.1}) {
      System system = make_hall(Material{.friction = 0.6, .rolling = coefficient});
      const double v = std::sqrt(radius), slowing = coefficient * g / (1 + 0.4);
      const BodyId ball = system.bodies().create(Sphere{radius}, {.position = {0, radius, 0},
                                                                  .velocity = {0.6 * v, 0, 0.8 * v},
                                                                  .spin = {0.8 * v / radius, 0, -0.6 * v / radius}});
      const double h = v / slowing / 300;
      for (int i = 0; i < 320; ++i) (void)system.step(h);
      const Vec3 way = system.bodies().center_of_mass(ball) - Vec3{0, radius, 0};
      EXPECT_NEAR(norm(way), v * v / (2 * slowing), 1e-3 * norm(way));
      EXPECT_NEAR(way.x / way.z, 0.75, 1e-6);
      EXPECT_LT(norm(system.bodies().velocity(ball)), 1e-12);
    }
}

TEST(RollingResistance, holds_a_ball_on_a_slope_up_to_its_coefficient) {
  for (const double share : {0.98, 1.02, 2.0}) {
    constexpr double coefficient = 0.05, seconds = 2;
    const double angle = std::atan(share * coefficient);
    System system = make_hall(Material{.friction = 0.6, .rolling = coefficient});
    system.set_gravity({g * std::sin(angle), -g * std::cos(angle), 0});
    const BodyId ball = drop_ball(system, 0, 0.1);
    for (int i = 0; i < seconds * 120; ++i) (void)system.step(1.0 / 120);
    const double pull = g * (std::sin(angle) - coefficient * std::cos(angle));
    const double way = std::max(0.0, pull / 1.4 * seconds * seconds / 2);
    EXPECT_NEAR(system.bodies().center_of_mass(ball).x, way, 1e-5 + 0.01 * way);
  }
}

TEST(RollingResistance, slows_a_cylinder_by_its_inertia) {
  System system = make_hall(Material{.friction = 0.6, .rolling = 0.05});
  const double half = std::sqrt(0.5);
  const BodyId roll = system.bodies().create(
      Cylinder{0.1, 0.2},
      {.position = {0, 0.1, 0}, .orientation = {0, half, 0, half}, .velocity = {1, 0, 0}, .spin = {0, 0, -10}});
  for (int i = 0; i < 480; ++i) (void)system.step(1.0 / 120);
  EXPECT_NEAR(system.bodies().center_of_mass(roll).x, 1 / (2 * 0.05 * g / 1.5), 1e-2);
  EXPECT_LT(norm(system.bodies().velocity(roll)), 1e-12);
}

TEST(RollingResistance, between_two_that_move_keeps_both_momenta) {
  System system;
  system.set_gravity({}), system.set_usual_material(Material{.friction = 0.5, .rolling = 0.3});
  (void)system.bodies().create(Sphere{0.1}, {.position = {-0.1, 0, 0}, .velocity = {1, 0, 0}, .spin = {0, 9, 4}});
  const BodyId b = system.bodies().create(Sphere{0.2}, {.position = {0.22, 0.02, 0}, .velocity = {-1, 0, 0}});
  const Vec3 linear = system.momentum(), angular = system.angular_momentum();
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 240);
  EXPECT_LT(norm(system.momentum() - linear), 1e-10 * norm(linear));
  EXPECT_LT(norm(system.angular_momentum() - angular), 1e-7 * norm(linear));
  EXPECT_GT(norm(system.bodies().angular_velocity(b)), 1e-3);
}

/// The share of its spin that the law says, of what a ball that falls without friction loses by resistance until some time after.
double share_of_loss(IntegrationMode mode, bool by_sweeps, const Material& material, double height, double per_second) {
  constexpr double radius = 0.1, spin = 30, after = 0.05;
  System system = make_hall(material, mode);
  if (by_sweeps) system.set_budget({.contacts = 1});
  const bool rolls = material.rolling > 0;
  const BodyId ball = system.bodies().create(
      Sphere{radius}, {.position = {0, radius + height, 0}, .spin = rolls ? Vec3{0, 0, spin} : Vec3{0, spin, 0}});
  const double speed = std::sqrt(2 * g * height), fall = speed / g;
  const int steps = static_cast<int>(std::lround((fall + after) * per_second));
  for (int i = 0; i < steps; ++i) (void)system.step(1 / per_second);
  const double rests = material.restitution > 0 ? 0 : steps / per_second - fall;
  const double law =
      2.5 * (material.rolling + material.spinning) / radius * (speed * (1 + material.restitution) + g * rests);
  return (spin - norm(system.bodies().angular_velocity(ball))) / law;
}

TEST(RollingResistance, and_that_against_spinning_take_their_share_of_an_impact_once) {
  for (const bool rolls : {true, false})
    for (const double e : {0.0, 0.5})
      for (const double height : {0.3, 0.31, 0.33}) {
        const Material material{
            .friction = 0, .restitution = e, .rolling = rolls ? 0.02 : 0, .spinning = rolls ? 0 : 0.02};
        const auto share = [&](IntegrationMode mode, bool by_sweeps) {
          return share_of_loss(mode, by_sweeps, material, height, 240);
        };
        EXPECT_NEAR(share(IntegrationMode::energy_keeping, false), 1, 0.02) << height << " m, restitution " << e;
        EXPECT_NEAR(share(IntegrationMode::robust, false), 1, 0.08) << height << " m, restitution " << e;
        EXPECT_NEAR(share(IntegrationMode::robust, true), 1, 0.02) << height << " m, restitution " << e;
      }
}

TEST(RollingResistance, takes_what_its_law_says_from_a_fast_spin_in_every_mode) {
  for (const IntegrationMode mode : both_modes)
    for (const Vec3& spin : {Vec3{0, 0, 30}, Vec3{0, 30, 0}}) {
      constexpr double radius = 0.1, h = 1.0 / 60;
      System system = make_hall(Material{.friction = 0, .rolling = 0.02, .spinning = 0.02}, mode);
      const BodyId ball = system.bodies().create(Sphere{radius}, {.position = {0, radius, 0}, .spin = spin});
      for (int i = 0; i < 30; ++i) (void)system.step(h);
      const double loss = 2.5 * 0.02 * g / radius * 30 * h;
      EXPECT_NEAR(norm(system.bodies().angular_velocity(ball)), 30 - loss, 0.01 * loss);
    }
}

TEST(Materials, refuse_coefficients_without_a_meaning) {
  System system;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (const Material& material :
       {Material{.friction = -1}, Material{.restitution = -0.1}, Material{.restitution = 1.1},
        Material{.restitution = none}, Material{.rolling = -1}, Material{.rolling = none},
        Material{.rolling = std::numeric_limits<double>::infinity()}}) {
    EXPECT_THROW(system.set_usual_material(material), std::invalid_argument);
    EXPECT_EQ(system.usual_material(), std::nullopt);
  }
}

}  // namespace
}  // namespace iota
