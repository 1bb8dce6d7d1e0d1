// SPDX-License-Identifier: Apache-2.0
#include "ingredient/loads.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace iota {
namespace {

/// A bit of everything, hanging on a nail: rods that spin, blocks, a locked pair, a motor hinge with a spring, bonds of three
/// laws, different dampings, a grip; and a stone that flies by itself.
struct Contraption {
  System system;
  std::vector<BodyId> bodies;
  std::vector<ParticleId> free_ends;

  Contraption(std::uint32_t seed, IntegrationMode mode) : system({.gravity = {0.3, -9.81, 0.1}, .mode = mode}) {
    std::mt19937 generator(seed);
    const auto random = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(generator()) / 4294967296.0;
    };
    const auto somewhere = [&](double size) {
      return Vec3{random(-size, size), random(-size, size), random(-size, size)};
    };
    system.set_damping(random(0, 0.5));

    ParticleId last{};
    Vec3 at;
    for (int i = 0; i < 4; ++i) {  // a chain of rods
      const BodyId rod = system.bodies().create();
      const Vec3 end = at + Vec3{random(0.3, 0.6), random(-0.3, 0.3), random(-0.3, 0.3)};
      const ParticleId p = system.particles().create(rod, at), q = system.particles().create(rod, end);
      system.bodies().set_rod(rod, random(0.5, 2), 0.05);
      if (i == 0)
        system.particles().nail(p);
      else
        (void)system.edits().combine(last, p);
      bodies.push_back(rod), last = q, at = end;
    }
    // A locked pair of blocks on the last rod, a third block on a motor hinge.
    const auto block = [&](const Vec3& center) {
      return system.bodies().create(
          Box{{0.4, 0.2, 0.3}},
          {.mass = random(0.5, 2), .position = center, .attachments = {{-0.2, 0, 0}, {0.2, 0.1, 0}, {0, 0.1, 0.15}}});
    };
    const BodyId first = block(at + Vec3{0.2, 0, 0}), second = block(at + Vec3{0.6, -0.1, 0});
    (void)system.edits().combine(last, system.bodies().attachments(first)[0]);
    free_ends = {system.bodies().attachments(first)[2], system.bodies().attachments(second)[2]};
    (void)system.edits().combine(first, second);
    const BodyId third = block(at + Vec3{0.2, -0.4, 0});
    system.joints().create(JointSpec{.a = first,
                                     .b = third,
                                     .at = at + Vec3{0.2, -0.2, 0},
                                     .axis = {0, 0, 1},
                                     .angle = {.motor_speed = 2, .motor_max = 0.5, .stiffness = 3, .damping = 0.1}});
    const ParticleId low = system.bodies().attachments(third)[2];
    system.bonds().create(low, free_ends[0], SpringLaw{50, 1, 0.3});
    system.bonds().create(free_ends[1], low, DragLaw{0.4});
    const BodyId stone = system.bodies().create();
    (void)system.particles().create(stone, {2, 0, 0}, 0.5, somewhere(1));
    system.bodies().set_damping(stone, random(0, 1));
    const BodyId ball = system.bodies().create();
    const ParticleId weight = system.particles().create(ball, at + Vec3{0.3, -0.9, 0.1});
    system.bonds().create(weight, low, SpringLaw{20, 0, 0.4});
    bodies.insert(bodies.end(), {first, third, ball, stone});
    system.bodies().set_damping(third, random(0, 1));
    system.bodies().set_damping(bodies[2], random(0, 1));  // not that of the rods that it is hinged to
    const double violence = mode == IntegrationMode::robust ? 1 : 0.1;
    (void)system.grips().create(first, {0.1, 0, 0}, at + somewhere(0.3 * violence));
    system.bodies().set_angular_velocity(bodies[1], violence * (somewhere(2) + Vec3{40, 0, 0}));
  }
};

constexpr double load_step = 1.0 / 240;

/// The largest difference between the load from outside and the change of momenta, over the forces that the solver balances:
/// 2 kg by 1 m / load_step^2. It stops at 1e-9 of those (the mid-point rule at 1e-10).
double calc_worst_imbalance(const Contraption& c) {
  double worst = 0;
  for (const BodyId body : c.bodies) {
    const Vec3 force = c.system.bodies().outside_force(body, {}), torque = c.system.bodies().outside_torque(body, {});
    worst = std::max(
        {worst, norm(force - c.system.bodies().net_force(body)), norm(torque - c.system.bodies().net_torque(body))});
  }
  return worst / (2 / (load_step * load_step));
}

StepReport push_and_step(Contraption& c) {
  for (const ParticleId p : c.free_ends) c.system.particles().apply_force(p, {1, -2, 0.5});
  return c.system.step(load_step);
}

TEST(Loads, from_outside_are_mass_times_acceleration) {
  for (const IntegrationMode mode :
       {IntegrationMode::plausible, IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    // In the step in which the motor reaches its speed forces are means; the late ones have their directions at its end.
    int checked = 0, reached = 0;
    for (std::uint32_t seed = 0; seed < 50; ++seed) {
      Contraption c(seed, mode);
      for (int i = 0; i < 40; ++i) {
        const StepReport report = push_and_step(c);
        if (report.substeps_max > 1 || report.fallbacks > 0) continue;  // multipliers are of the last sub-step
        ++checked;
        const double imbalance = calc_worst_imbalance(c);
        const bool is_of_start = mode == IntegrationMode::energy_keeping && imbalance >= 1e-9;
        reached += is_of_start;
        ASSERT_LT(imbalance, is_of_start                          ? 1e-6
                             : mode == IntegrationMode::plausible ? 1e-7
                                                                  : 1e-9)
            << "mode " << static_cast<int>(mode) << " seed " << seed << " step " << i;
      }
    }
    EXPECT_GT(checked, 1000);
    EXPECT_LE(reached, 10);
  }
}

TEST(Loads, from_outside_are_mass_times_acceleration_in_accurate_mode_too) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    Contraption c(seed, IntegrationMode::accurate);
    const StepReport report = push_and_step(c);
    if (report.substeps_max > 1 || report.fallbacks > 0) continue;
    ASSERT_LT(calc_worst_imbalance(c), 1e-9) << "seed " << seed;
  }
}

TEST(Loads, of_one_hinge_add_up_to_zero) {
  Contraption c(3, IntegrationMode::energy_keeping);
  for (int i = 0; i < 20; ++i) {
    (void)c.system.step(1e-3);
    for (std::size_t b = 0; b + 1 < 4; ++b) {
      const ParticleId q = c.system.bodies().particles(c.bodies[b])[1],
                       p = c.system.bodies().particles(c.bodies[b + 1])[0];
      EXPECT_LT(norm(c.system.particles().hinge_force(q) + c.system.particles().hinge_force(p)), 1e-9);
    }
  }
}

}  // namespace
}  // namespace iota
