// SPDX-License-Identifier: Apache-2.0
// The dial from plausible to accurate, any time step, and what no step may do.
#include "gravity.h"
#include "scenes/chain.h"
#include "scenes/net.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace iota {
namespace {

/// Two point masses on massless rods of unit length, the angles from straight down: state (a, b, da, db), by
/// Runge-Kutta in steps of 1e-4 s.
std::array<double, 4> double_pendulum(std::array<double, 4> y, double seconds) {
  const auto slope = [](const std::array<double, 4>& s) {
    const auto [a, b, u, w] = s;
    const double d = a - b, bottom = 3 - std::cos(2 * d);
    return std::array<double, 4>{
        u, w,
        (-3 * g * std::sin(a) - g * std::sin(a - 2 * b) - 2 * std::sin(d) * (w * w + u * u * std::cos(d))) / bottom,
        2 * std::sin(d) * (2 * u * u + 2 * g * std::cos(a) + w * w * std::cos(d)) / bottom};
  };
  const double h = 1e-4;
  for (int i = 0; i < std::lround(seconds / h); ++i) {
    const auto along = [&](const std::array<double, 4>& k, double t) {
      auto z = y;
      for (int j = 0; j < 4; ++j) z[j] += t * k[j];
      return z;
    };
    const auto k1 = slope(y), k2 = slope(along(k1, h / 2)), k3 = slope(along(k2, h / 2)), k4 = slope(along(k3, h));
    for (int j = 0; j < 4; ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
  }
  return y;
}

/// Distance of the lower mass from the truth after `seconds`, m, and the worst sub-steps of a step.
std::pair<double, int> pendulum_error(IntegrationMode mode, double dt, double seconds) {
  System system{SystemOptions{.mode = mode}};
  const BodyId upper = system.bodies().create(), lower = system.bodies().create();
  const ParticleId top = system.particles().create(upper, {0, 0, 0}, 1),
                   middle = system.particles().create(upper, {1, 0, 0}, 1);
  const ParticleId joint = system.particles().create(lower, {1, 0, 0}, 1e-9),
                   end = system.particles().create(lower, {2, 0, 0}, 1);
  (void)system.edits().combine(middle, joint);
  system.particles().nail(top);
  int substeps = 0;
  for (int i = 0; i < std::lround(seconds / dt); ++i) substeps = std::max(substeps, system.step(dt).substeps_max);
  const double quarter = std::acos(-1.0) / 2;
  const auto truth = double_pendulum({quarter, quarter, 0, 0}, seconds);
  const Vec3 expected{std::sin(truth[0]) + std::sin(truth[1]), -std::cos(truth[0]) - std::cos(truth[1]), 0};
  return {norm(system.particles().position(end) - expected), substeps};
}

/// A rod of 1 m that turns by more than a radian even in a 64th of a frame: each of its sub-steps falls back.
void add_whirling_rod(System& system, const Vec3& place) {
  const BodyId rod = system.bodies().create();
  system.particles().create(rod, place + Vec3{0.5, 0, 0}, 1, {0, 4000, 0});
  system.particles().create(rod, place - Vec3{0.5, 0, 0}, 1, {0, -4000, 0});
}

TEST(Report, adds_up_the_fall_backs_of_all_islands) {
  const auto fallbacks_of = [](int rods) {
    System system{SystemOptions{.gravity = {}}};
    for (int i = 0; i < rods; ++i) add_whirling_rod(system, {3.0 * i, 0, 0});
    return system.step(1.0 / 60).fallbacks;
  };
  const int of_one = fallbacks_of(1);
  EXPECT_GT(of_one, 0) << "nothing is tested unless the energy-keeping scheme gives up";
  EXPECT_EQ(fallbacks_of(3), 3 * of_one);
  EXPECT_EQ(fallbacks_of(0), 0);
}

TEST(Mode, accurate_follows_a_double_pendulum_at_any_frame_rate) {
  for (const double hz : {30.0, 60.0, 240.0}) {
    const double accurate = pendulum_error(IntegrationMode::accurate, 1 / hz, 2).first;
    EXPECT_LT(accurate, 1e-4) << "chaotic, two seconds, links of 1 m";
    const double keeping = pendulum_error(IntegrationMode::energy_keeping, 1 / hz, 2).first;
    EXPECT_GT(keeping, 3 * accurate) << "else there is nothing to gain";
  }
}

TEST(Mode, energy_keeping_is_of_second_order) {
  const double coarse = pendulum_error(IntegrationMode::energy_keeping, 1.0 / 240, 1).first;
  const double fine = pendulum_error(IntegrationMode::energy_keeping, 1.0 / 480, 1).first;
  EXPECT_NEAR(coarse / fine, 4, 0.2);
}

TEST(Mode, can_be_turned_at_any_time) {
  System system;
  scenes::make_chain(system, {.links = 20});
  const double start = system.energy().total();
  for (const auto mode : {IntegrationMode::plausible, IntegrationMode::accurate, IntegrationMode::robust,
                          IntegrationMode::energy_keeping}) {
    system.set_mode(mode);
    for (int i = 0; i < 30; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_EQ(report.unconverged, 0);
      ASSERT_LT(report.worst_gap, mode == IntegrationMode::plausible ? 1e-7 : 1e-9);
      ASSERT_LT(report.energy.total(), start + 1e-7);
    }
  }
}

TEST(Mode, energy_keeping_of_64_links_drifts_by_nothing_that_grows) {
  // 100 000 steps, as `iota verify` takes them, end at 1e-11 as well.
  System system;
  const double angle = 10 * std::acos(-1.0) / 180;
  scenes::make_chain(system, {.links = 64, .direction = {std::sin(angle), -std::cos(angle), 0}});
  System at_rest;
  scenes::make_chain(at_rest, {.links = 64, .direction = {0, -1, 0}});
  const double start = system.energy().total(), above_rest = start - at_rest.energy().total();
  double worst = 0;
  int fallbacks = 0;
  for (int i = 0; i < 10000; ++i) {
    const StepReport report = system.step(1.0 / 240);
    worst = std::max(worst, std::abs(report.energy.total() - start));
    fallbacks += report.fallbacks;
  }
  EXPECT_LT(worst, 1e-9 * above_rest);
  EXPECT_EQ(fallbacks, 0);
}

TEST(TimeStep, may_be_another_one_every_frame) {
  for (const auto mode : {IntegrationMode::plausible, IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system{SystemOptions{.mode = mode}};
    const auto chain = scenes::make_chain(system, {.links = 30, .rods = true});
    system.bonds().create(chain.lower[10], chain.lower[29], SpringLaw{.stiffness = 200});
    const double start = system.energy().total();
    std::mt19937 random(4);
    double kinetic = 0;
    for (int i = 0; i < 600; ++i) {
      const double dt = std::pow(10, std::uniform_real_distribution<double>(-5, -1)(random));
      const StepReport report = system.step(dt);
      kinetic = std::max(kinetic, report.energy.kinetic);
      ASSERT_EQ(report.unconverged, 0);
      ASSERT_LT(report.worst_gap, 1e-7);
      ASSERT_LT(report.energy.total(), start + 1e-7 * kinetic);
    }
    if (mode == IntegrationMode::energy_keeping) {
      EXPECT_GT(system.energy().total(), start - 1e-6 * kinetic);
    }
  }
}

/// Bodies of all ranks with masses over six decades, hinged at random, loops and springs included.
System random_scene(std::uint64_t seed, IntegrationMode mode) {
  std::mt19937_64 random(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto index = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  System system{SystemOptions{.mode = mode}};
  std::vector<ParticleId> all;
  for (int b = 0; b < 10; ++b) {
    const BodyId body = system.bodies().create();
    const std::size_t count = 2 + index(4);
    const Vec3 at = all.empty() ? Vec3{} : system.particles().position(all[index(all.size())]);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 x = at + (i == 0 ? Vec3{} : Vec3{number(-1, 1), number(-1, 1), number(-1, 1)});
      const Vec3 v{number(-2, 2), number(-2, 2), number(-2, 2)};
      const ParticleId p = system.particles().create(body, x, std::pow(10, number(-3, 3)), v);
      if (i == 0 && !all.empty())
        for (const ParticleId q : all)
          if (system.particles().position(q) == x) {
            (void)system.edits().combine(q, p);
            break;
          }
      all.push_back(p);
    }
  }
  for (int i = 0; i < 6; ++i) {
    const ParticleId p = all[index(all.size())], q = all[index(all.size())];
    if (p != q) system.bonds().create(p, q, SpringLaw{.stiffness = std::pow(10, number(0, 5))});
  }
  if (index(2) == 0) system.particles().nail(all[0]);
  return system;
}

TEST(Robust, never_gains_energy) {
  double kinetic = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    System system = random_scene(seed, seed % 2 ? IntegrationMode::robust : IntegrationMode::plausible);
    const double dt = std::array{1.0 / 240, 1.0 / 60, 1.0 / 30, 0.1}[seed / 2 % 4];
    (void)system.step(1e-4);  // random velocities are made consistent
    double last = system.energy().total();
    for (int i = 0; i < 60; ++i) {
      const StepReport report = system.step(dt);
      const double now = report.energy.total();
      ASSERT_LE(now, last + 1e-12 * (std::abs(now) + report.energy.kinetic)) << "seed " << seed << " step " << i;
      ASSERT_LT(report.worst_gap, 1e-6);
      last = now, kinetic = std::max(kinetic, report.energy.kinetic);
    }
  }
  EXPECT_GT(kinetic, 1e3) << "a dead world would pass the rest";
}

/// A chain between two nails, 2 n links of `length`, as far apart as it is long: no slack at all.
TEST(Singular, chain_stretched_between_two_nails_stays_and_can_be_let_go) {
  for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system{SystemOptions{.mode = mode}};
    const auto chain = scenes::make_chain(system, {.links = 20, .link_length = 0.1});
    system.particles().nail(chain.lower.back());
    int iterations = 0;
    for (int i = 0; i < 120; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_TRUE(std::isfinite(report.energy.total()));
      ASSERT_LT(report.worst_gap, 1e-5) << "a straight chain cannot carry its weight: it must give or be held";
      ASSERT_NEAR(system.particles().position(chain.lower[9]).x, 1, 1e-3);
      iterations = std::max(iterations, report.iterations_max);
    }
    system.particles().release(chain.lower.back());
    const double start = system.energy().total();
    for (int i = 0; i < 120; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_LT(report.worst_gap, 1e-9);
      ASSERT_EQ(report.unconverged, 0);
      ASSERT_LT(report.energy.total(), start + 1e-6);
    }
    EXPECT_LT(system.particles().position(chain.lower.back()).y, -0.5) << "free again";
  }
}

TEST(Singular, conflict_that_has_stood_for_long_ends_at_once_when_a_nail_comes_back) {
  // Two links between nails 2.5 m apart, straight but for a hair, and a pendulum that goes on swinging from their elbow.
  System system;
  const auto arm = scenes::make_chain(system, {.links = 2, .link_length = 1});
  const auto tail = scenes::make_chain(system, {.links = 1, .link_length = 1, .nailed = false, .top = {1, 0, 0}});
  (void)system.edits().combine(arm.lower[0], tail.upper[0]);
  (void)system.step(1.0 / 60);
  system.particles().nail(arm.lower[1], {2.5, 0, 0});
  for (int i = 0; i < 300; ++i) {
    const StepReport report = system.step(1.0 / 60);
    ASSERT_EQ(report.unconverged, 1);
    ASSERT_LT(report.energy.kinetic, 30);
  }
  system.particles().nail(arm.lower[1], {1.9, 0, 0});
  (void)system.step(1.0 / 60);
  EXPECT_LT(norm(system.particles().position(arm.lower[0])), 10)
      << "the elbow once went 11 km, to meet a nail that comes at 36 m/s";
  const StepReport report = system.step(1.0 / 60);
  EXPECT_EQ(report.unconverged, 0);
  EXPECT_LT(report.worst_gap, 1e-9);
  EXPECT_LT(report.energy.kinetic, 100);
}

/// Thesis Fig. 4.14: an arm of two links reaches its full extension while it is pulled further.
TEST(Singular, arm_pulled_beyond_its_reach_gives_without_a_hiccup) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId upper = system.bodies().create(), lower = system.bodies().create();
  const Vec3 elbow{0.85, -std::sqrt(1 - 0.85 * 0.85), 0};
  system.particles().nail(system.particles().create(upper, {0, 0, 0}));
  const ParticleId above = system.particles().create(upper, elbow), below = system.particles().create(lower, elbow);
  const ParticleId hand = system.particles().create(lower, {1.7, 0, 0});
  (void)system.edits().combine(above, below);
  system.particles().nail(hand);
  int substeps = 0;
  for (int i = 1; i <= 480; ++i) {  // in to 1.2, out to 2.2 and back in, twice
    const double reach = 1.7 - 0.5 * std::sin(std::acos(-1.0) * i / 120);
    system.particles().nail(hand, {reach, 0, 0});
    const StepReport report = system.step(1.0 / 60);
    ASSERT_TRUE(std::isfinite(report.energy.total()));
    ASSERT_LT(report.energy.kinetic, 100) << "the elbow snaps out of the straight line, once each way";
    substeps += report.substeps_max;
    ASSERT_LT(report.worst_gap, 0.07) << "a third of what is missing, at each of three places";
    if (reach < 1.9) {
      ASSERT_LT(report.worst_gap, 1e-8) << i;
      ASSERT_EQ(report.unconverged, 0) << i;
    }
  }
  EXPECT_LT(substeps, 800) << "held to their lengths they took 3000";
  EXPECT_LT(std::abs(system.energy().external_work), 1e5)
      << "pulled against lengths that do not yield, the nail does no work";
}

TEST(Mode, accurate_goes_through_a_whip_without_falling_back) {
  System system({.mode = IntegrationMode::accurate});
  (void)scenes::make_chain(system, {.links = 64, .rods = true});
  const double start = system.energy().total();
  for (int i = 0; i < 144; ++i) {  // the end cracks after 1.1 s, in a hundred sub-steps a step
    const StepReport report = system.step(1.0 / 120);
    ASSERT_EQ(report.fallbacks, 0) << i;
  }
  EXPECT_NEAR(system.energy().total(), start, 1e-7 * system.energy().kinetic);
}

TEST(FarFromTheOrigin, round_off_of_places_is_not_chased) {
  for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system({.mode = mode});
    (void)scenes::make_chain(system, {.links = 1000, .rods = true, .top = {2e5, 0, 0}});  // 3e-11 m apart there
    for (int i = 0; i < 30; ++i) {
      const StepReport report = system.step(1.0 / 120);
      ASSERT_EQ(report.fallbacks + report.unconverged, 0);
      ASSERT_LE(report.iterations_max, 12);
    }
  }
}

/// Positions of the knots of a net that falls from two nails, after a quarter of a second.
std::vector<Vec3> fall_of_a_net(System& system, bool forgets_factors) {
  const scenes::Net net = scenes::make_net(system, {.side = 16});
  for (int i = 0; i < 30; ++i) {
    if (forgets_factors) (void)system.snapshot();
    const StepReport report = system.step(1.0 / 120);
    EXPECT_EQ(report.fallbacks + report.unconverged, 0) << i;
  }
  std::vector<Vec3> knots;
  for (const ParticleId knot : net.knots) knots.push_back(system.particles().position(knot));
  return knots;
}

TEST(HeldNet, moves_by_the_factors_of_the_step_before_as_by_its_own) {
  System carries({.mode = IntegrationMode::robust}), forgets({.mode = IntegrationMode::robust});
  const std::vector<Vec3> a = fall_of_a_net(carries, false), b = fall_of_a_net(forgets, true);
  double difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference = std::max(difference, norm(a[i] - b[i]));
  EXPECT_LT(difference, 1e-11) << "m";
  EXPECT_NE(carries.state_hash(), forgets.state_hash()) << "neither began with the factors of the step before";
}

TEST(HeldNet, goes_on_after_a_snapshot_as_one_that_is_restored_from_it) {
  System system({.mode = IntegrationMode::robust}), restored;
  (void)scenes::make_net(system, {.side = 16});
  (void)system.step(1.0 / 120, 20);
  restored.restore(system.snapshot());
  for (int i = 0; i < 20; ++i) {
    (void)system.step(1.0 / 120), (void)restored.step(1.0 / 120);
    ASSERT_EQ(system.state_hash(), restored.state_hash()) << i;
  }
}

/// Two boxes in space that an attachment of each hinges to the other: a carried particle of both.
struct HingedBoxes {
  HingedBoxes() {
    const auto box = [&](double x, double attachment) {
      return system.bodies().create(Box{0.2, 0.3, 0.4},
                                    {.mass = 2, .position = {x, 0, 0}, .attachments = {{attachment, 0.1, 0.2}}});
    };
    upper = box(0, 0.1), lower = box(0.2, -0.1);
    (void)system.edits().combine(system.bodies().attachments(upper)[0], system.bodies().attachments(lower)[0]);
  }
  System system{{.gravity = {}}};
  BodyId upper, lower;
};

/// The second island was there already, and lost what was given to carried particles: the momentum rose by a third.
TEST(AssignedVelocity, of_a_hinged_solid_acts_in_the_same_way_before_the_first_step_and_later) {
  HingedBoxes fresh, later;
  (void)later.system.step(1.0 / 120);
  for (HingedBoxes* const boxes : {&fresh, &later}) {
    boxes->system.bodies().set_velocity(boxes->upper, {0, 3, 1});
    const Vec3 given = boxes->system.momentum();
    (void)boxes->system.step(1.0 / 120);
    EXPECT_LT(norm(boxes->system.momentum() - given), 1e-12);
  }
  EXPECT_LT(norm(fresh.system.bodies().velocity(fresh.lower) - later.system.bodies().velocity(later.lower)), 1e-9);
}

TEST(AssignedVelocity, of_a_hinged_solid_acts_in_the_same_way_in_a_restored_system) {
  HingedBoxes boxes;
  (void)boxes.system.step(1.0 / 120);
  boxes.system.bodies().set_velocity(boxes.upper, {0, 3, 1});
  System restored;
  restored.restore(boxes.system.snapshot());
  (void)boxes.system.step(1.0 / 120), (void)restored.step(1.0 / 120);
  EXPECT_EQ(boxes.system.state_hash(), restored.state_hash());
}

}  // namespace
}  // namespace iota
