// SPDX-License-Identifier: Apache-2.0
#include "ingredient/angle_springs.h"
#include "modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace iota {
namespace {

using std::numbers::pi;

/// Three single particles without gravity: the middle one at the origin, the last one along x.
struct Bent {
  System system;
  std::array<ParticleId, 3> ends;  ///< the middle one is the second
  AngleSpringId spring;

  Bent(IntegrationMode mode, double angle, std::array<double, 2> lengths, const AngleSpringOptions& options,
       std::array<double, 3> masses = {1, 1, 1})
      : system(SystemOptions{.gravity = {}, .mode = mode}) {
    const std::array places{lengths[0] * Vec3{std::cos(angle), std::sin(angle), 0}, Vec3{}, Vec3{lengths[1], 0, 0}};
    for (std::size_t i = 0; i < 3; ++i)
      ends[i] = system.particles().create(system.bodies().create(), places[i], masses[i]);
    spring = system.angle_springs().create(ends[0], ends[1], ends[2], options);
  }
  /// Turns the first leg.
  void set_angle(double angle, double length) {
    system.particles().set_position(ends[0], length * Vec3{std::cos(angle), std::sin(angle), 0});
  }
  double potential() { return system.energy().potential; }
};

TEST(AngleSprings, have_their_least_energy_and_their_stiffness_at_the_rest_angle) {
  for (const double rest : {0.3, 1.0, 2.0, 3.0, pi})
    for (const double leg : {1e-3, 0.5, 4.0, 1e3}) {
      Bent bent(IntegrationMode::robust, rest, {leg, 1}, {.stiffness = 2.5, .rest = rest});
      constexpr double step = 1e-3;
      EXPECT_NEAR(bent.potential(), 0, 1e-20);
      std::array<double, 2> turned{};
      for (const int side : {0, 1}) {
        bent.set_angle(rest + (side == 0 ? -step : step), leg);
        turned[static_cast<std::size_t>(side)] = bent.potential();
      }
      EXPECT_NEAR((turned[0] + turned[1]) / (step * step), 2.5, 2.5e-3) << rest << " " << leg;
      EXPECT_NEAR(turned[1] - turned[0], 0, 2.5 * step * step * step / std::tan(rest / 2) + 1e-12) << rest;
    }
}

TEST(AngleSprings, have_the_moment_by_which_their_energy_falls_with_the_angle) {
  Bent bent(IntegrationMode::robust, 1.2, {0.7, 1.9}, {.stiffness = 3, .rest = 2});
  EXPECT_NEAR(bent.system.angle_springs().angle(bent.spring), 1.2, 1e-14);
  const double moment = bent.system.angle_springs().moment(bent.spring);
  bent.set_angle(1.2 - 1e-5, 0.7);
  const double before = bent.potential();
  bent.set_angle(1.2 + 1e-5, 0.7);
  EXPECT_NEAR(moment, (before - bent.potential()) / 2e-5, 1e-8);
  EXPECT_GT(moment, 0);
}

/// From rest each particle gets minus the derivative of the energy by its place, times the time.
TEST(AngleSprings, push_each_particle_against_the_slope_of_their_energy) {
  for (const IntegrationMode mode : all_modes) {
    Bent bent(mode, 0.8, {0.7, 1.9}, {.stiffness = 3, .rest = 2.2}, {1, 2, 3});
    const Snapshot start = bent.system.snapshot();
    std::array<Vec3, 3> slope;
    const auto derivative = [&](std::size_t i, const Vec3& along) {
      const Vec3 place = bent.system.particles().position(bent.ends[i]);
      bent.system.particles().set_position(bent.ends[i], place + 1e-6 * along);
      const double after = bent.potential();
      bent.system.particles().set_position(bent.ends[i], place - 1e-6 * along);
      const double before = bent.potential();
      bent.system.particles().set_position(bent.ends[i], place);
      return (after - before) / 2e-6;
    };
    for (std::size_t i = 0; i < 3; ++i)
      slope[i] = {derivative(i, {1, 0, 0}), derivative(i, {0, 1, 0}), derivative(i, {0, 0, 1})};
    bent.system.restore(start);
    constexpr double h = 1e-5;
    (void)bent.system.step(h);
    for (std::size_t i = 0; i < 3; ++i) {
      const double mass = static_cast<double>(i + 1);
      EXPECT_LT(norm(mass / h * bent.system.particles().velocity(bent.ends[i]) + slope[i]), 1e-5) << i;
      const BodyId body = bent.system.particles().body(bent.ends[i]);
      EXPECT_LT(norm(bent.system.bodies().net_force(body) + slope[i]), 1e-5) << i;
    }
  }
}

TEST(AngleSprings, keep_momentum_and_where_the_mode_does_angular_momentum) {
  for (const IntegrationMode mode : all_modes)
    for (const double rest : {1.0, pi}) {
      Bent bent(mode, 2.5, {0.7, 1.9}, {.stiffness = 30, .rest = rest}, {1, 2, 3});
      bent.system.particles().set_velocity(bent.ends[0], {0.3, 0.1, 0.8});
      bent.system.particles().set_velocity(bent.ends[2], {0.1, -0.4, 0.2});
      const Vec3 linear = bent.system.momentum(), angular = bent.system.angular_momentum();
      for (int i = 0; i < 240; ++i) EXPECT_EQ(bent.system.step(1.0 / 120).unconverged, 0);
      EXPECT_LT(norm(bent.system.momentum() - linear), 1e-10);
      if (mode == IntegrationMode::energy_keeping || mode == IntegrationMode::accurate) {
        EXPECT_LT(norm(bent.system.angular_momentum() - angular), 1e-9) << static_cast<int>(mode);
      }
    }
}

/// The end-point modes give the angular momentum that they lose back to what rods hold together, as far as the energy
/// that a step has lost suffices.
TEST(AngleSprings, between_rods_keep_angular_momentum_in_all_modes) {
  for (const IntegrationMode mode : all_modes) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    std::array<BodyId, 2> rods{system.bodies().create(), system.bodies().create()};
    const ParticleId p = system.particles().create(rods[0], {-1, 0.5, 0}, 1, {0, 1, 1});
    const ParticleId left = system.particles().create(rods[0], {}, 1);
    const ParticleId right = system.particles().create(rods[1], {}, 1);
    const ParticleId q = system.particles().create(rods[1], {0.5, 0.5, 0}, 2, {1, -1, 1});
    (void)system.edits().combine(left, right);
    (void)system.angle_springs().create(p, left, q, {.stiffness = 20, .rest = pi});
    (void)system.step(1.0 / 120);  // projects the velocities
    const Vec3 angular = system.angular_momentum();
    for (int i = 0; i < 240; ++i) EXPECT_EQ(system.step(1.0 / 120).unconverged, 0);
    const bool is_mid_point = mode == IntegrationMode::energy_keeping || mode == IntegrationMode::accurate;
    const double allowed = is_mid_point ? 1e-9 : 5e-3;
    EXPECT_LT(norm(system.angular_momentum() - angular), allowed * norm(angular)) << static_cast<int>(mode);
  }
}

TEST(AngleSprings, keep_the_energy_book_and_only_their_damping_dissipates) {
  for (const IntegrationMode mode : all_modes)
    for (const double damping : {0.0, 0.2}) {
      Bent bent(mode, 1.2, {0.7, 1.9}, {.stiffness = 30, .damping = damping, .rest = 2.2}, {1, 2, 3});
      const double start = bent.system.energy().total();
      for (int i = 0; i < 240; ++i) (void)bent.system.step(1.0 / 240);
      const Energy energy = bent.system.energy();
      EXPECT_GT(start, 1);
      EXPECT_LT(energy.made, 1e-8 * start);
      EXPECT_GE(energy.dissipated, damping > 0 ? 0.1 * start : 0);
      EXPECT_LE(energy.dissipated, damping > 0 ? start : 1e-12);
      if (mode == IntegrationMode::energy_keeping) {
        EXPECT_NEAR(energy.total() + energy.dissipated, start, 1e-8 * start);
      }
    }
}

/// m - M - m with rigid legs: its bending vibration has (2 pi f)^2 = 4 k / (mu l^2), mu = 2 m M / (2 m + M).
TEST(AngleSprings, let_a_straight_molecule_bend_with_its_frequency_in_any_units) {
  constexpr double m = 1, big = 2, mu = 2 * m * big / (2 * m + big), omega = 2 * pi;
  for (const IntegrationMode mode : all_modes)
    for (const double length : {1e-3, 1.0, 1e3})
      for (const double mass : {1e-6, 1.0, 1e6}) {
        System system{SystemOptions{.gravity = {}, .mode = mode}};
        const double tilt = 1e-3;
        std::array<BodyId, 2> rods{system.bodies().create(), system.bodies().create()};
        const ParticleId p = system.particles().create(rods[0], {-length, tilt * length, 0}, mass * m);
        const ParticleId left = system.particles().create(rods[0], {}, mass * big / 2);
        const ParticleId right = system.particles().create(rods[1], {}, mass * big / 2);
        const ParticleId q = system.particles().create(rods[1], {length, tilt * length, 0}, mass * m);
        (void)system.edits().combine(left, right);
        const double stiffness = omega * omega * mu * mass * length * length / 4;
        (void)system.angle_springs().create(p, left, q, {.stiffness = stiffness, .rest = pi});
        const auto bend = [&] {
          const Particles particles = system.particles();
          return particles.position(p).y + particles.position(q).y - 2 * particles.position(left).y;
        };
        // After a quarter of its period of 1 s it is straight; half a period later again.
        std::vector<double> crossings;
        double before = bend();
        constexpr double h = 1e-3;
        for (int i = 1; i <= 800; ++i) {
          EXPECT_EQ(system.step(h).unconverged, 0);
          const double now = bend();
          if (before * now < 0) crossings.push_back(h * (i - now / (now - before)));
          before = now;
        }
        ASSERT_EQ(crossings.size(), 2u) << length << " " << mass;
        EXPECT_NEAR(crossings[1] - crossings[0], 0.5, 2e-4) << length << " " << mass << " " << static_cast<int>(mode);
      }
}

/// Rods clamped at one end, a springy beam: with joints of k = EI / l at the distances a from the tip, a force F at the tip lowers it
/// by F / k times the sum of a^2, for small slopes.
TEST(AngleSprings, make_a_clamped_chain_bend_as_a_beam_of_any_stiffness) {
  for (const IntegrationMode mode : all_modes)
    for (const double stiffness : {1e3, 1e6, 1e9, 1e12}) {
      constexpr int count = 8;
      constexpr double length = 0.25;
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      system.set_damping(4);
      std::vector<ParticleId> left, right;
      for (int i = 0; i < count; ++i) {
        const BodyId rod = system.bodies().create();
        left.push_back(system.particles().create(rod, {i * length, 0, 0}));
        right.push_back(system.particles().create(rod, {(i + 1) * length, 0, 0}));
        system.bodies().set_rod(rod, 1, 0.01);
        if (i > 0) (void)system.edits().combine(right[static_cast<std::size_t>(i) - 1], left.back());
      }
      system.particles().nail(left[0]);
      system.particles().nail(right[0]);
      double squares = 0;
      for (std::size_t i = 1; i < count; ++i) {
        (void)system.angle_springs().create(left[i - 1], left[i], right[i],
                                            {.stiffness = stiffness, .damping = 0.05 * stiffness, .rest = pi});
        squares += std::pow(length * static_cast<double>(count - i), 2);
      }
      const double force = 1e-4 * stiffness, sag = force / stiffness * squares;
      for (int i = 0; i < 240; ++i) {
        system.particles().apply_force(right.back(), {0, -force, 0});
        EXPECT_EQ(system.step(1.0 / 60).unconverged, 0) << stiffness;
      }
      EXPECT_NEAR(-system.particles().position(right.back()).y, sag, 2e-3 * sag) << stiffness << static_cast<int>(mode);
    }
}

TEST(AngleSprings, survive_undo_snapshots_and_replays) {
  Bent bent(IntegrationMode::energy_keeping, 1.2, {0.7, 1.9}, {.stiffness = 30, .rest = 2.2});
  System& system = bent.system;
  system.record().start();
  system.angle_springs().set(bent.spring, {.stiffness = 20, .rest = 1.5});
  for (int i = 0; i < 20; ++i) (void)system.step(1.0 / 60);
  system.edits().begin();
  system.angle_springs().destroy(bent.spring);
  (void)system.edits().end();
  EXPECT_FALSE(system.angle_springs().contains(bent.spring));
  system.edits().undo();
  EXPECT_TRUE(system.angle_springs().contains(bent.spring));
  EXPECT_EQ(system.angle_springs().options(bent.spring).rest, 1.5);
  EXPECT_EQ(system.angle_springs().ends(bent.spring), bent.ends);
  for (int i = 0; i < 20; ++i) (void)system.step(1.0 / 60);
  const Recording recording = system.record().stop();
  System copy;
  EXPECT_EQ(copy.record().replay(recording), std::nullopt);
  copy.restore(system.snapshot());
  (void)copy.step(1.0 / 60), (void)system.step(1.0 / 60);
  EXPECT_EQ(copy.state_hash(), system.state_hash());
  EXPECT_EQ(copy.validate(), std::vector<std::string>{});
}

TEST(AngleSprings, end_with_a_particle_and_rest_where_two_of_them_are_hinged) {
  Bent bent(IntegrationMode::robust, 1.2, {0.7, 1.9}, {.stiffness = 30, .rest = 2.2});
  System& system = bent.system;
  for (int i = 0; i < 2; ++i) (void)system.edits().combine(bent.ends[0], bent.ends[1]);  // a hinge, then one particle
  EXPECT_FALSE(system.angle_springs().contains(bent.spring));
  EXPECT_EQ(system.validate(), std::vector<std::string>{});

  Bent other(IntegrationMode::robust, 1.2, {0.7, 1.9}, {.stiffness = 30, .rest = 2.2});
  other.system.particles().destroy(other.ends[1]);
  EXPECT_TRUE(other.system.angle_springs().ids().empty());
  EXPECT_EQ(other.system.validate(), std::vector<std::string>{});

  System rods{SystemOptions{.gravity = {}}};
  std::vector<ParticleId> ends;
  for (int i = 0; i < 3; ++i) {
    const BodyId rod = rods.bodies().create();
    ends.push_back(rods.particles().create(rod, {1.0 * i, 0, 0}));
    (void)rods.particles().create(rod, {1.0 * i, 0, 1});
  }
  const AngleSpringId spring = rods.angle_springs().create(ends[0], ends[1], ends[2], {.stiffness = 5, .rest = 1});
  EXPECT_GT(rods.energy().potential, 1);
  (void)rods.edits().combine(ends[0], ends[1]);
  EXPECT_EQ(rods.angle_springs().moment(spring), 0);
  EXPECT_EQ(rods.energy().potential, 0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(rods.step(1.0 / 60).unconverged, 0);
  EXPECT_NEAR(rods.energy().balance(), 0, 1e-9);
  (void)rods.edits().separate(ends[0], ends[1]);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(rods.step(1.0 / 60).unconverged, 0);
  EXPECT_EQ(rods.validate(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iota
