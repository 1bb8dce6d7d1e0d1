// SPDX-License-Identifier: Apache-2.0
#include "scenes/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>

namespace iota {
namespace {

using scenes::ChainOptions;
using scenes::make_chain;

struct Swing {
  double gap = 0, start = 0, end = 0, highest = -1e300, kinetic = 0, book_error = 0;
  int fallbacks = 0, unconverged = 0, iterations = 0;
};

Swing swing(IntegrationMode mode, const ChainOptions& options, double dt, double seconds) {
  System system{SystemOptions{.mode = mode}};
  make_chain(system, options);
  Swing run;
  run.start = system.energy().total();
  const int steps = static_cast<int>(std::lround(seconds / dt));
  for (int i = 0; i < steps; ++i) {
    const StepReport report = system.step(dt);
    run.gap = std::max(run.gap, report.worst_gap);
    run.highest = std::max(run.highest, report.energy.total());
    run.kinetic = std::max(run.kinetic, report.energy.kinetic);
    run.fallbacks += report.fallbacks, run.unconverged += report.unconverged;
    run.iterations = std::max(run.iterations, report.iterations_max);
    run.book_error = std::max(run.book_error, std::abs(report.energy.balance() - run.start));
  }
  run.end = system.energy().total();
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
  return run;
}

void expect_exact(const Swing& run, const char* what, const Swing& twin) {
  EXPECT_LE(run.gap, 1e-9);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_LE(run.highest, run.start + 1e-8 * run.kinetic) << "energy may not rise above its start";
  EXPECT_LE(twin.highest, twin.start + 1e-8 * twin.kinetic);
  EXPECT_LE(twin.gap, 1e-9);
  EXPECT_GT(run.kinetic, 0.5 * twin.kinetic) << "a dead world would pass the rest";
  EXPECT_LT(run.book_error, 1e-6 * run.kinetic);
  const double loss = (run.start - run.end) / run.kinetic, twin_loss = (twin.start - twin.end) / twin.kinetic;
  std::printf(
      "  %s: gap %.1e m, energy lost %.2e of the largest kinetic energy; the implicit Euler of robust mode loses %.2e\n",
      what, run.gap, loss, twin_loss);
  EXPECT_LT(std::abs(loss), std::max(1e-6, 0.5 * twin_loss));
}

TEST(Chain, of_64_links_released_horizontally_keeps_hinges_and_energy) {
  const ChainOptions options{.links = 64};
  expect_exact(swing(IntegrationMode::energy_keeping, options, 1.0 / 120, 10), "64 links",
               swing(IntegrationMode::robust, options, 1.0 / 120, 10));
}

TEST(Chain, of_64_rods_keeps_hinges_and_energy) {
  const ChainOptions options{.links = 64, .rods = true};
  expect_exact(swing(IntegrationMode::energy_keeping, options, 1.0 / 120, 10), "64 rods",
               swing(IntegrationMode::robust, options, 1.0 / 120, 10));
}

TEST(Chain, with_a_thousandfold_heavy_end_keeps_hinges_and_energy) {
  const ChainOptions options{.links = 64, .heavy_end = 1000};
  expect_exact(swing(IntegrationMode::energy_keeping, options, 1.0 / 120, 10), "64 links, 1000:1",
               swing(IntegrationMode::robust, options, 1.0 / 120, 10));
}

TEST(Chain, with_a_millionfold_heavy_end_stays_whole_at_sixty_steps_a_second) {
  // With 101 links a whip has solutions whose pivots have the wrong sign: steps that were once given up.
  for (const int links : {100, 101})
    for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
      const Swing run = swing(mode, {.links = links, .heavy_end = 1e6}, 1.0 / 60, 8);
      EXPECT_LE(run.gap, 1e-7);
      EXPECT_EQ(run.unconverged, 0);
      EXPECT_EQ(run.fallbacks, 0);
      EXPECT_LE(run.highest, run.start + 1e-12 * run.kinetic);
      if (mode == IntegrationMode::energy_keeping) {
        EXPECT_GT(run.end, run.start - 1e-6 * run.kinetic);
      }
    }
}

TEST(Chain, of_2000_rods_cracks_like_a_whip_and_goes_on) {
  // Here a step once ended with every link at rest: nothing had converged.
  const Swing run = swing(IntegrationMode::energy_keeping, {.links = 2000, .rods = true}, 1.0 / 60, 7);
  EXPECT_EQ(run.unconverged, 0);
  EXPECT_LE(run.gap, 1e-9);
  EXPECT_LT(std::abs(run.end - run.start), 1e-3 * run.kinetic);
}

TEST(Chain, cost_grows_linearly_no_iteration_explosion_at_4096_links) {
  const Swing run = swing(IntegrationMode::robust, {.links = 4096}, 1.0 / 60, 0.5);
  EXPECT_LE(run.gap, 1e-9);
  EXPECT_LE(run.iterations, 12);
}

TEST(Rod, has_the_period_of_a_solid_cylinder) {
  // A compound pendulum at a small angle: omega^2 = m g (L/2) / (It + m L^2/4).
  System system;
  const double length = 0.5, radius = 0.1, mass = 2, angle = 1e-3;
  const BodyId rod = system.bodies().create();
  const ParticleId top = system.particles().create(rod, {0, 0, 0});
  const ParticleId end = system.particles().create(rod, {length * std::sin(angle), -length * std::cos(angle), 0});
  system.bodies().set_rod(rod, mass, radius);
  system.particles().nail(top);
  const double inertia = mass * (3 * radius * radius + length * length) / 12 + mass * length * length / 4;
  const double period = 2 * std::acos(-1.0) * std::sqrt(inertia / (mass * 9.81 * length / 2));
  const double dt = period / 400;
  for (int i = 0; i < 400; ++i) (void)system.step(dt);
  EXPECT_NEAR(system.particles().position(end).x, length * std::sin(angle), 1e-3 * length * angle);
  for (int i = 0; i < 200; ++i) (void)system.step(dt);
  EXPECT_NEAR(system.particles().position(end).x, -length * std::sin(angle), 1e-3 * length * angle);
}

}  // namespace
}  // namespace iota
