// SPDX-License-Identifier: Apache-2.0
#include "tests/cpp/scattered.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota {
namespace {

TEST(FreeParticles, move_as_the_solver_moves_them) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust}) {
    std::vector<std::vector<double>> ends;
    std::vector<Energy> energies;
    for (const bool held : {false, true}) {
      System system(SystemOptions{.mode = mode, .damping = 0.1});
      const auto particles = scatter(system, 20, 3);
      system.bodies().set_damping(system.particles().body(particles[3]), 0.5);
      if (held)  // bonds without force: they bring the particles into islands
        for (int i = 0; i < 20; i += 2) system.bonds().create(particles[i], particles[i + 1], DragLaw{0});
      system.fields().create("fx = -3*x; fy = -3*y + 0.1*vx; fz = m*sin(t)");
      for (int i = 0; i < 200; ++i) {
        if (i % 10 == 0) system.particles().apply_force(particles[5], {1, 2, 3});
        const StepReport report = system.step(1.0 / 120);
        ASSERT_EQ(report.unconverged, 0);
        ASSERT_NEAR(report.energy.balance(), system.energy().balance(), 1e-12);
      }
      ends.push_back(positions(system));
      energies.push_back(system.energy());
    }
    for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_NEAR(ends[0][i], ends[1][i], 1e-10);
    EXPECT_NEAR(energies[0].dissipated, energies[1].dissipated, 1e-8);
    EXPECT_NEAR(energies[0].external_work, energies[1].external_work, 1e-8);
    EXPECT_GT(std::abs(energies[0].external_work), 0.1);
  }
}

TEST(FreeParticles, are_taken_into_islands_and_let_go_again) {
  System system;
  const auto particles = scatter(system, 6, 4);
  const double start = system.energy().balance();
  const auto run = [&] {
    for (int i = 0; i < 10; ++i) ASSERT_NEAR(system.step(0.01).energy.balance(), start, 1e-9);
    ASSERT_EQ(system.validate(), std::vector<std::string>{});
  };
  run();
  const BondId bond = system.bonds().create(particles[0], particles[1], SpringLaw{});
  run();
  system.bonds().set_active(bond, false);
  run();
  system.bonds().set_active(bond, true);
  system.edits().combine(particles[2], particles[3]);
  run();
  system.edits().separate(particles[2], particles[3]);
  system.bonds().destroy(bond);
  run();
  const GripId grip = system.grips().create(system.particles().body(particles[4]), {}, {0, 0, 0});
  run();
  EXPECT_GT(system.energy().external_work, -1e9);
  system.grips().destroy(grip);
  system.particles().nail(particles[5]);
  run();
  system.particles().release(particles[5]);
  const Snapshot saved = system.snapshot();
  run();
  const std::uint64_t hash = system.state_hash();
  system.restore(saved);
  run();
  EXPECT_EQ(system.state_hash(), hash);
}

TEST(FreeParticles, pushed_by_an_absurd_force_stay_where_they_are) {
  System system;
  const auto particles = scatter(system, 2, 4);
  const Vec3 before = system.particles().position(particles[0]);
  system.particles().apply_force(particles[0], {1e9, 0, 0});
  (void)system.step(0.01);
  EXPECT_NE(system.particles().position(particles[0]), before);
  const Vec3 there = system.particles().position(particles[0]);
  const FieldId field = system.fields().create("fx = f", {.parameters = {{"f", 1e29}}});
  EXPECT_GT(system.step(0.01).unconverged, 0);
  EXPECT_EQ(system.particles().position(particles[0]), there);
  system.fields().set_parameter(field, "f", 1.5e308);
  const StepReport report = system.step(0.01);
  EXPECT_EQ(report.warnings.size(), 1u) << "this is no force";
  EXPECT_TRUE(std::isfinite(report.energy.kinetic));
}

}  // namespace
}  // namespace iota
