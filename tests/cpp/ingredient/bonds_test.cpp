// SPDX-License-Identifier: Apache-2.0
#include "ingredient/bonds.h"
#include "modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace iota {
namespace {

constexpr double gram = 1e-3, weight = 9.81 * gram, h = 1.0 / 60;

struct Hung {
  System system;
  ParticleId nailed, free;
  BondId bond;
  int failures = 0;

  Hung(IntegrationMode mode, const Vec3& place, BondLaw law, Vec3 gravity = {0, -9.81, 0})
      : system(SystemOptions{.gravity = gravity, .mode = mode}) {
    nailed = system.particles().create(system.bodies().create(), {0, 2, 0}, gram);
    free = system.particles().create(system.bodies().create(), place, gram);
    system.particles().nail(nailed);
    bond = system.bonds().create(nailed, free, law);
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) {
      const StepReport report = system.step(h);
      failures += report.unconverged + report.fallbacks;
    }
  }
};

/// A pendulum of 1 g: a spring of any stiffness above 1e6 N/m is a rod. Released from the side it turns in a plane, and
/// sin^2 of its angle has the energy: v^2 / 2 = g drop, up to what the mode loses.
TEST(StiffSpring, of_any_stiffness_swings_as_a_rod_does) {
  for (const IntegrationMode mode : all_modes) {
    System rod{SystemOptions{.mode = mode}};
    const BodyId body = rod.bodies().create();
    rod.particles().nail(rod.particles().create(body, {0, 2, 0}, gram));
    const ParticleId end = rod.particles().create(body, {0.6, 1.2, 0}, gram);
    for (int i = 0; i < 60; ++i) (void)rod.step(h);
    for (const double stiffness : {1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18}) {
      Hung hung(mode, {0.6, 1.2, 0}, SpringLaw{.stiffness = stiffness, .length = 1});
      const double start = hung.system.energy().total();
      hung.step(60);
      EXPECT_EQ(hung.failures, 0) << stiffness;
      EXPECT_LT(norm(hung.system.particles().position(hung.free) - rod.particles().position(end)), 2e-4) << stiffness;
      EXPECT_NEAR(norm(hung.system.particles().position(hung.free) - Vec3{0, 2, 0}), 1, 1e-8) << stiffness;
      EXPECT_LT(hung.system.energy().made, 1e-8 * weight) << stiffness;
      if (mode == IntegrationMode::energy_keeping || mode == IntegrationMode::accurate) {
        EXPECT_NEAR(hung.system.energy().total(), start, 1e-6 * weight) << stiffness;
      }
    }
  }
}

/// At rest its force is the weight, although its stretch is less than the round-off of its length.
TEST(StiffSpring, at_rest_carries_the_weight) {
  for (const IntegrationMode mode : all_modes)
    for (const double stiffness : {1.0, 1e3, 1e6, 1e9, 1e12, 1e15, 1e18}) {
      Hung hung(mode, {0, 1 - weight / stiffness, 0}, SpringLaw{.stiffness = stiffness, .length = 1});
      hung.step(60);
      EXPECT_EQ(hung.failures, 0) << stiffness;
      EXPECT_NEAR(hung.system.bonds().force(hung.bond).y, -weight, 1e-6 * weight) << stiffness;
      EXPECT_NEAR(hung.system.particles().nail_force(hung.nailed).y, 2 * weight, 1e-6 * weight) << stiffness;
    }
}

/// m v' = m g - c v from rest: after a time t it has sunk by (m g / c) (t - m/c (1 - exp(-c t / m))).
TEST(StiffDashpot, of_any_strength_sinks_by_its_analytic_way) {
  for (const IntegrationMode mode : all_modes)
    for (double c = 1e3; c < 2e18; c *= 10)
      for (const bool is_drag : {true, false}) {
        const BondLaw law =
            is_drag ? BondLaw{DragLaw{.damping = c}} : BondLaw{SpringLaw{.stiffness = 0, .damping = c, .length = 1}};
        Hung hung(mode, {0, 1, 0}, law);
        hung.step(60);
        const double sunk = weight / c * (1 - gram / c);
        EXPECT_EQ(hung.failures, 0) << c;
        EXPECT_NEAR(1 - hung.system.particles().position(hung.free).y, sunk, 0.02 * sunk + 1e-12) << c << is_drag;
        EXPECT_LT(hung.system.energy().made, 1e-8 * weight + 1e-24 * c) << c;  // of round-off
      }
}

/// Two grams that fly apart at 2 m/s: a stiff spring between them only stops the rate of their distance.
TEST(StiffSpring, between_two_free_particles_keeps_momentum_and_spin) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping})
    for (const double stiffness : {1e8, 1e12, 1e18}) {
      System system{SystemOptions{.gravity = {}, .mode = mode}};
      const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, gram, {1, 1, 0.5});
      const ParticleId q = system.particles().create(system.bodies().create(), {0.6, 0.8, 0}, gram, {1, -1, 0});
      (void)system.bonds().create(p, q, SpringLaw{.stiffness = stiffness, .damping = 1, .length = 1});
      const Vec3 linear = system.momentum(), angular = system.angular_momentum();
      for (int i = 0; i < 60; ++i) EXPECT_EQ(system.step(h).unconverged, 0);
      EXPECT_LT(norm(system.momentum() - linear), 1e-9 * gram) << stiffness;
      EXPECT_LT(norm(system.angular_momentum() - angular), 1e-6 * gram) << stiffness;
      EXPECT_NEAR(norm(system.particles().position(q) - system.particles().position(p)), 1, 1e-6) << stiffness;
    }
}

TEST(StiffSpring, may_become_soft_and_stiff_again) {
  Hung hung(IntegrationMode::robust, {0.6, 1.2, 0}, SpringLaw{.stiffness = 1e12, .length = 1});
  hung.step(10);
  hung.system.bonds().set_parameter(hung.bond, "stiffness", 10);
  hung.step(10);
  EXPECT_GT(norm(hung.system.particles().position(hung.free) - Vec3{0, 2, 0}), 1 + 1e-5);
  hung.system.bonds().set_parameter(hung.bond, "stiffness", 1e12);
  hung.step(60);
  EXPECT_NEAR(norm(hung.system.particles().position(hung.free) - Vec3{0, 2, 0}), 1, 1e-6);
  EXPECT_EQ(hung.failures, 0);
  EXPECT_EQ(hung.system.validate(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iota
