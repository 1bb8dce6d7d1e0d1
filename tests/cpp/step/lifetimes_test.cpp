// SPDX-License-Identifier: Apache-2.0
// Particles that are born, age, turn and die.
#include "energy_book.h"
#include "vectors.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace iota {
namespace {

const EmitterOptions fountain{.rate = 200,
                              .position = {0, 1, 0},
                              .velocity = {0, 3, 0},
                              .velocity_spread = 0.5,
                              .lifetime = 0.5,
                              .lifetime_spread = 0.2,
                              .curve = {{0, 0.01, {1, 1, 0, 1}}, {0.5, 0.03, {1, 0, 0, 1}}, {1, 0, {0, 0, 0, 0}}}};

TEST(Emitter, emits_at_its_rate_and_removes_particles_after_their_lifetime) {
  System system;
  const EmitterId emitter = system.emitters().create(fountain);
  std::size_t born = 0, died = 0;
  for (int i = 0; i < 300; ++i) {
    const StepReport report = system.step(0.01);
    born += report.born.size(), died += report.died.size();
    for (const ParticleId p : report.died) EXPECT_FALSE(system.particles().contains(p));
    for (const ParticleId p : report.born) EXPECT_TRUE(system.particles().contains(p));
  }
  EXPECT_EQ(born, 600u);
  EXPECT_EQ(system.emitters().born(emitter), 600u);
  EXPECT_EQ(system.emitters().count(emitter), born - died);
  EXPECT_EQ(system.particles().ids().size(), born - died);
  EXPECT_NEAR(system.emitters().count(emitter), 200 * 0.5, 15);  // births a second times the mean lifetime
  for (const ParticleId p : system.emitters().particles(emitter)) EXPECT_LT(system.particles().attributes(p).age, 0.7);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Emitter, its_particles_fly_as_they_were_thrown) {
  System system;
  EmitterOptions options = fountain;
  options.velocity_spread = 0, options.source = Sphere{1e-6}, options.rate = 70, options.lifetime = 10;
  const EmitterId emitter = system.emitters().create(options);
  for (int i = 0; i < 50; ++i) (void)system.step(0.01);
  for (const ParticleId p : system.emitters().particles(emitter)) {
    const double t = system.particles().attributes(p).age;
    EXPECT_NEAR(system.particles().position(p).y, 1 + 3 * t - 9.81 * t * t / 2, 1e-5);
    EXPECT_NEAR(system.particles().velocity(p).y, 3 - 9.81 * t, 1e-8);
  }
}

TEST(Emitter, its_particles_are_born_within_its_source) {
  System system({.gravity = {}});
  for (const Shape& source :
       {Shape{Sphere{0.5}}, Shape{Box{{1, 2, 3}}}, Shape{Cylinder{0.3, 2}}, Shape{Capsule{0.3, 2}}, Shape{Torus{}}}) {
    const EmitterId emitter = system.emitters().create({.rate = 5000, .source = source, .velocity = {}});
    (void)system.step(0.2);
    const MassProperties exact = mass_properties(source);
    Vec3 squares;
    for (const ParticleId p : system.emitters().particles(emitter)) {
      const Vec3 x = system.particles().position(p);
      squares += (1.0 / system.emitters().count(emitter)) * Vec3{x.x * x.x, x.y * x.y, x.z * x.z};
    }
    EXPECT_EQ(system.emitters().count(emitter), 1000u);
    EXPECT_NEAR(squares.x / exact.mean_squares[0].x, 1, 0.15);  // evenly, as the mass of a solid is
    EXPECT_NEAR(squares.y / exact.mean_squares[1].y, 1, 0.15);
    EXPECT_NEAR(squares.z / exact.mean_squares[2].z, 1, 0.15);
    system.emitters().destroy(emitter);
  }
  EXPECT_THROW((void)system.emitters().create({.source = HalfSpace{}}), std::invalid_argument);
  EXPECT_THROW((void)system.emitters().create({.source = Mesh{}}), std::invalid_argument);
}

TEST(Emitter, no_more_than_its_most_are_alive) {
  System system;
  const EmitterId emitter = system.emitters().create({.rate = 1000, .lifetime = 100, .max_count = 50});
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.emitters().count(emitter), 50u);
  system.bodies().destroy(system.particles().body(system.emitters().particles(emitter)[0]));
  EXPECT_EQ(system.emitters().count(emitter), 49u);
  (void)system.step(0.01);
  EXPECT_EQ(system.emitters().count(emitter), 50u);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Emitter, equal_seeds_give_equal_particles_and_replays_equal_hashes) {
  const auto run = [](std::uint64_t seed) {
    System system;
    EmitterOptions options = fountain;
    options.seed = seed;
    (void)system.emitters().create(options);
    for (int i = 0; i < 100; ++i) (void)system.step(0.01);
    return system.state_hash();
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5), run(6));
  System system;
  (void)system.emitters().create(fountain);
  for (int i = 0; i < 40; ++i) (void)system.step(0.01);
  system.record().start();
  for (int i = 0; i < 40; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.record().replay(system.record().stop()), std::nullopt);
}

TEST(Emitter, attributes_follow_the_curve_of_life) {
  System system;
  EmitterOptions options = fountain;
  options.lifetime = 1, options.lifetime_spread = 0;
  const EmitterId emitter = system.emitters().create(options);
  for (int i = 0; i < 25; ++i) (void)system.step(0.01);
  for (const ParticleId p : system.emitters().particles(emitter)) {
    const ParticleAttributes a = system.particles().attributes(p);
    EXPECT_NEAR(a.radius, 0.01 + 0.04 * a.age, 1e-9);
    EXPECT_NEAR(a.color[1], 1 - 2 * a.age, 1e-6);
  }
  const ParticleId first = system.emitters().particles(emitter)[0];
  const double radius = system.particles().attributes(first).radius;
  system.emitters().destroy(emitter);
  EXPECT_EQ(system.particles().attributes(first).radius, radius);
  for (int i = 0; i < 100; ++i) (void)system.step(0.01);
  EXPECT_FALSE(system.particles().contains(first));
  EXPECT_EQ(system.particles().ids().size(), 0u);
}

TEST(Emitter, the_energy_book_adds_up_through_births_and_deaths) {
  System system;
  (void)system.emitters().create(fountain);
  for (int i = 0; i < 200; ++i) (void)system.step(0.01);
  EXPECT_NEAR(book(system), 0, 1e-9);
}

TEST(Lifetime, any_particle_dies_at_its_time_and_takes_its_bonds_along) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  const ParticleId p = system.particles().create(a, {0, 0, 0}), q = system.particles().create(b, {1, 0, 0});
  const BondId bond = system.bonds().create(p, q, SpringLaw{});
  system.particles().set_attributes(q, {.lifetime = 0.035, .radius = 0.2});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(system.step(0.01).died.empty());
  EXPECT_NEAR(system.particles().attributes(q).age, 0.03, 1e-15);
  EXPECT_EQ(system.step(0.01).died, std::vector<ParticleId>{q});
  EXPECT_FALSE(system.bonds().contains(bond));
  EXPECT_FALSE(system.bodies().contains(b));
  EXPECT_TRUE(system.validate().empty());
}

struct Surfel {
  System system{{.gravity = {}}};
  ParticleId p = system.particles().create(system.bodies().create(), {});
  Surfel() { system.particles().set_orientation(p, {}); }
};

TEST(Oriented, free_spin_is_exact_whatever_the_step) {
  for (const double h : {0.001, 0.1}) {
    Surfel s;
    const Vec3 spin{0.3, -0.4, 1.2};  // rad/s
    s.system.particles().set_spin(s.p, spin);
    const double energy = s.system.energy().kinetic;
    const Vec3 angular = s.system.angular_momentum();
    for (double t = 0; t < 1 - 1e-9; t += h) (void)s.system.step(h);
    EXPECT_EQ(s.system.particles().spin(s.p), spin);
    EXPECT_EQ(s.system.energy().kinetic, energy);
    EXPECT_EQ(s.system.angular_momentum(), angular);
    const Quaternion q = s.system.particles().orientation(s.p);  // the turn about the spin by its length
    const double angle = norm(spin), sine = std::sin(angle / 2) / angle;
    EXPECT_NEAR(q.w, std::cos(angle / 2), 1e-12);
    expect_near({q.x, q.y, q.z}, sine * spin, 1e-12);
  }
}

TEST(Oriented, a_torque_turns_it_as_newton_says) {
  Surfel s;
  s.system.particles().set_moment(s.p, 2);
  for (int i = 0; i < 100; ++i) {
    s.system.particles().apply_torque(s.p, {0, 0, 4});
    (void)s.system.step(0.01);
  }
  expect_near(s.system.particles().spin(s.p), {0, 0, 2}, 1e-12);  // torque / moment * 1 s
  EXPECT_NEAR(s.system.energy().kinetic, 4, 1e-12);
  EXPECT_NEAR(s.system.energy().external_work, 4, 1e-12);
  const Quaternion q = s.system.particles().orientation(s.p);
  EXPECT_NEAR(2 * std::atan2(q.z, q.w), 1, 1e-12);  // half the acceleration
  (void)s.system.step(0.01);
  expect_near(s.system.particles().spin(s.p), {0, 0, 2}, 1e-12);  // for one step only
}

TEST(Oriented, is_drawn_with_its_normal_to_its_preferred_direction) {
  Surfel s;
  s.system.particles().align(s.p, {1, 0, 1}, 1e4, 10);  // far stiffer than a step resolves
  for (int i = 0; i < 300; ++i) (void)s.system.step(0.05);
  expect_near(s.system.particles().normal(s.p), {std::sqrt(0.5), 0, std::sqrt(0.5)}, 1e-6);
  EXPECT_LT(norm(s.system.particles().spin(s.p)), 1e-6);
  EXPECT_NEAR(book(s.system), 0, 1e-12);
}

TEST(Oriented, spin_is_damped_and_booked) {
  Surfel s;
  s.system.particles().set_spin(s.p, {0, 2, 0});
  s.system.particles().set_spin_damping(s.p, 3);
  for (int i = 0; i < 10; ++i) (void)s.system.step(0.1);
  expect_near(s.system.particles().spin(s.p), {0, 2 * std::exp(-3.0), 0}, 1e-12);
  EXPECT_NEAR(book(s.system), 0, 1e-15);
}

TEST(Oriented, it_is_drawn_as_it_is_turned) {
  Surfel s;
  const Quaternion quarter{0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  s.system.particles().set_orientation(s.p, quarter);
  EXPECT_NEAR(s.system.bodies().orientation(s.system.particles().body(s.p)).z, quarter.z, 1e-15);
}

TEST(Oriented, what_has_no_orientation_says_so) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {});
  EXPECT_FALSE(system.particles().is_oriented(p));
  EXPECT_THROW((void)system.particles().spin(p), std::invalid_argument);
  EXPECT_THROW(system.particles().set_spin(p, {}), std::invalid_argument);
  EXPECT_THROW(system.particles().apply_torque(p, {}), std::invalid_argument);
  EXPECT_THROW(system.particles().set_orientation(p, {0, 0, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace iota
