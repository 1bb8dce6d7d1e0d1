// SPDX-License-Identifier: Apache-2.0
// Where energy goes: dissipated by laws, lost or made by the scheme, each counted by itself.
#include "modes.h"
#include "scenes/chain.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace iota {
namespace {

/// Two particles on a damped spring in empty space. The stretch is s(t) = s0 e^(-ct) (cos wt + c/w sin wt) with c = d / (2 mu);
/// the dashpot has taken what the oscillator has no more.
TEST(EnergyBook, turns_no_body_at_rest_for_the_energy_of_its_noise) {
  System system({.gravity = {}});
  const BodyId body = system.bodies().create();
  const Vec3 places[] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.3, 0}, {0.5, -0.3, 0}, {0.5, 0, 0.3}, {0.5, 0, -0.3}};
  std::vector<ParticleId> points;
  for (const Vec3& place : places) points.push_back(system.particles().create(body, place));
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 120);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT(norm(system.particles().position(points[i]) - places[i]), 1e-13) << i;
}

TEST(EnergyBook, counts_the_work_of_a_dashpot_as_dissipated_and_the_scheme_s_own_as_lost) {
  for (const IntegrationMode mode : all_modes) {
    System system{SystemOptions{.gravity = {}, .mode = mode}};
    const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
    const ParticleId q = system.particles().create(system.bodies().create(), {1.2, 0, 0});
    system.bonds().create(p, q, SpringLaw{.stiffness = 100, .damping = 0.5, .length = 1});
    const double start = system.energy().total(), seconds = 1, h = 1.0 / 960;
    Energy last;
    for (int i = 0; i < std::lround(seconds / h); ++i) last = system.step(h).energy;
    const double mu = 0.5, c = 0.5 / (2 * mu), w = std::sqrt(100 / mu - c * c), e = std::exp(-c * seconds);
    const double stretch = 0.2 * e * (std::cos(w * seconds) + c / w * std::sin(w * seconds));
    const double rate = -0.2 * e * (w + c * c / w) * std::sin(w * seconds);
    const double taken = start - 50 * stretch * stretch - 0.5 * mu * rate * rate;
    const bool loses = mode == IntegrationMode::plausible || mode == IntegrationMode::robust;
    EXPECT_EQ(last.made, 0);
    EXPECT_NEAR(last.dissipated + last.lost, start - last.total(), 1e-12);
    if (loses) {
      EXPECT_GT(last.lost, 0.05 * start) << "backward Euler damps an oscillation of 14 rad/s by itself";
      EXPECT_GT(last.dissipated, 0.5 * taken);
      EXPECT_LT(last.dissipated, 0.95 * taken) << "of an oscillation that the scheme damps, too";
    } else {
      EXPECT_NEAR(last.lost, 0, 1e-9 * start);
      EXPECT_NEAR(last.dissipated, taken, 1e-4 * start);
    }
  }
}

/// The end-point rule can gain energy where a hand pushes a link; the rest of the motion gives that back.
TEST(EnergyBook, of_links_in_a_hand_has_nothing_made) {
  std::mt19937 random(4);
  std::normal_distribution<double> shake(0, 0.05);
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    for (const int links : {2, 3, 8}) {
      System system{SystemOptions{.mode = mode}};
      const auto chain = scenes::make_chain(system, {.links = links, .link_length = 2.4 / links});
      const BodyId held = chain.links[chain.links.size() / 2];
      Vec3 target = system.bodies().center_of_mass(held);
      const GripId grip = system.grips().create(held, {}, target);
      double kinetic = 0;
      for (int i = 0; i < 1200; ++i) {
        target += Vec3{shake(random), shake(random), shake(random)};
        system.grips().move(grip, target);
        const StepReport report = system.step(1.0 / 120);
        kinetic = std::max(kinetic, report.energy.kinetic);
        ASSERT_TRUE(report.warnings.empty()) << links << " links, step " << i << ": " << report.warnings.front();
      }
      EXPECT_GT(kinetic, 0.1);
      EXPECT_LT(system.energy().made, 1e-4 * kinetic) << links << " links";
    }
  }
}

TEST(EnergyBook, of_a_whipping_chain_has_nothing_made_and_shows_what_the_scheme_lost) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system{SystemOptions{.mode = mode}};
    (void)scenes::make_chain(system, {.links = 32});
    const double start = system.energy().balance();
    double kinetic = 0;
    Energy last;
    for (int i = 0; i < 480; ++i) {
      const StepReport report = system.step(1.0 / 120);
      last = report.energy, kinetic = std::max(kinetic, last.kinetic);
      ASSERT_EQ(last.made, 0);
      ASSERT_TRUE(report.warnings.empty());
      ASSERT_NEAR(last.balance(), start, 1e-10 * (kinetic + 1));
    }
    EXPECT_EQ(last.dissipated, 0) << "nothing dissipates";
    if (mode == IntegrationMode::robust) EXPECT_GT(last.lost, 0.1 * kinetic);
  }
}

/// Bars along the sides of squares, hung exactly taut by the corners, with a weight in the middle: the rows are elastic by
/// their compliance, and return no more than they have stored, except in parts shorter than a sixteenth of a step.
TEST(EnergyBook, of_a_taut_net_rises_at_no_time_above_its_start) {
  struct Case {
    IntegrationMode mode;
    double load;
    int hertz;
    double made = 0;  ///< at most, J
  };
  using enum IntegrationMode;
  constexpr double of_shortest_parts = 2;
  for (const auto& [mode, load, hertz, made] :
       {Case{robust, 0, 120}, Case{robust, 100, 120}, Case{robust, 100, 60}, Case{energy_keeping, 0, 120},
        Case{energy_keeping, 100, 120}, Case{energy_keeping, 100, 60, of_shortest_parts}}) {
    constexpr int side = 6;
    System system{SystemOptions{.mode = mode}};
    std::vector<ParticleId> knots(side * side);
    const auto place = [&](int i, int j) { return Vec3{0.1 * i, 2, 0.1 * j}; };
    const auto tie = [&](int knot, ParticleId p) {
      if (knots[knot] == ParticleId{})
        knots[knot] = p;
      else
        (void)system.edits().combine(knots[knot], p);
    };
    const auto add_bar = [&](int i, int j, int a, int c) {
      const BodyId bar = system.bodies().create();
      tie(i * side + j, system.particles().create(bar, place(i, j), 0.005));
      tie(a * side + c, system.particles().create(bar, place(a, c), 0.005));
    };
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        if (i + 1 < side) add_bar(i, j, i + 1, j);
        if (j + 1 < side) add_bar(i, j, i, j + 1);
      }
    for (const int corner : {0, side - 1, side * (side - 1), side * side - 1}) system.particles().nail(knots[corner]);
    if (load > 0) {
      const ParticleId weight = system.particles().create(system.bodies().create(), place(side / 2, side / 2), load);
      (void)system.edits().combine(knots[side * (side / 2) + side / 2], weight);
    }
    const double start = system.energy().total();
    for (int i = 0; i < 2 * hertz; ++i) {
      const StepReport report = system.step(1.0 / hertz);
      ASSERT_LE(report.energy.total(), start + 1e-9 * std::abs(start)) << load << " kg, " << hertz << " Hz, step " << i;
      ASSERT_EQ(report.unconverged, 0);
    }
    EXPECT_LE(system.energy().made, made + 1e-9 * std::abs(start)) << load << " kg, " << hertz << " Hz";
  }
}

/// Bodies of one to four particles in a random tree with springs, a nail or none: without edits nothing is made.
TEST(EnergyBook, of_four_hundred_random_scenes_has_nothing_made) {
  for (const IntegrationMode mode : all_modes)
    for (std::uint32_t seed = 1; seed <= 100; ++seed) {
      std::mt19937 random(seed);
      const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
      };
      const auto point = [&](double size) {
        return Vec3{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
      };
      System system{SystemOptions{.gravity = seed % 3 == 0 ? Vec3{} : Vec3{0, -9.81, 0}, .mode = mode}};
      std::vector<ParticleId> all;
      for (std::size_t bodies = 2 + random() % 6; bodies > 0; --bodies) {
        const BodyId body = system.bodies().create();
        const std::size_t count = 2 + random() % 3;
        const ParticleId joint = all.empty() ? ParticleId{} : all[random() % all.size()];
        const Vec3 first = all.empty() ? Vec3{} : system.particles().position(joint);
        for (std::size_t i = 0; i < count; ++i) {
          const ParticleId p = system.particles().create(body, i == 0 ? first : first + point(0.5),
                                                         std::pow(10, uniform(-1.5, 1.5)), point(1));
          if (i == 0 && !all.empty()) (void)system.edits().combine(joint, p);
          all.push_back(i == 0 && !(joint == ParticleId{}) ? joint : p);
        }
      }
      if (seed % 2 == 0) system.particles().nail(all[random() % all.size()]);
      for (std::size_t springs = random() % 4; springs > 0; --springs) {
        const ParticleId p = all[random() % all.size()], q = all[random() % all.size()];
        if (p == q) continue;
        system.bonds().create(
            p, q,
            SpringLaw{.stiffness = std::pow(10, uniform(0, 4)), .damping = uniform(0, 2), .length = uniform(0, 1)});
      }
      const double dt = 1.0 / std::array{30, 60, 120, 240}[random() % 4];
      double most = 0;
      for (int i = 0; i < (mode == IntegrationMode::accurate ? 6 : 30); ++i) {
        const Energy energy = system.step(dt).energy;
        most = std::max(most, std::abs(energy.total()) + energy.kinetic);
      }
      EXPECT_LE(system.energy().made, 1e-9 * most) << "seed " << seed << ", mode " << static_cast<int>(mode);
    }
}

}  // namespace
}  // namespace iota
