// SPDX-License-Identifier: Apache-2.0
// One behavior each: bodies of every rank, nails, bonds, grips, damping, conflicts, bad input.
#include "scenes/chain.h"
#include "tests/cpp/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace iota {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

void run(System& system, double seconds, double dt = 1.0 / 120) {
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    const StepReport report = system.step(dt);
    ASSERT_TRUE(std::isfinite(report.energy.total()));
    ASSERT_LT(report.worst_gap, 1e-9);
  }
}

TEST(Particle, that_is_alone_falls_freely) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 2, {1, 0, 0});
  run(system, 1);
  EXPECT_NEAR(system.particles().position(p).x, 1, 1e-12);
  EXPECT_NEAR(system.particles().position(p).y, -9.81 / 2, 1e-9) << "the mid-point rule is exact on a parabola";
}

TEST(Body, of_any_rank_keeps_its_shape_momentum_and_energy_while_it_tumbles) {
  const std::vector<std::vector<Vec3>> shapes = {
      {{0, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}, {0.3, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.7, 0}},
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.4, 0.4, 0.4}, {1, 1, 1}},
  };
  for (const auto& shape : shapes) {
    System system{SystemOptions{.gravity = {}}};
    const BodyId body = system.bodies().create();
    const Vec3 spin{0.7, 1.1, -0.4}, drift{0.1, 0.2, 0.3};
    std::vector<ParticleId> particles;
    for (std::size_t i = 0; i < shape.size(); ++i)
      particles.push_back(
          system.particles().create(body, shape[i], 1 + 0.3 * double(i), drift + cross(spin, shape[i])));
    const Vec3 momentum = system.momentum(), angular_momentum = system.angular_momentum();
    const double energy = system.energy().total();
    run(system, 3);
    for (std::size_t i = 0; i < shape.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_NEAR(norm(system.particles().position(particles[i]) - system.particles().position(particles[j])),
                    norm(shape[i] - shape[j]), 1e-9);
    EXPECT_NEAR(norm(system.momentum() - momentum), 0, 1e-11);
    EXPECT_NEAR(norm(system.angular_momentum() - angular_momentum), 0, 1e-9);
    EXPECT_NEAR(system.energy().total(), energy, 1e-9 * (1 + energy));
  }
}

/// A wheel on a nail above its hub, with pendulums hinged all round its rim.
void make_carousel(System& system, int pendulums) {
  const BodyId wheel = system.bodies().create();
  std::vector<ParticleId> rim;
  for (int i = 0; i < pendulums; ++i) {
    const double angle = 2 * std::numbers::pi * i / pendulums;
    rim.push_back(system.particles().create(wheel, {std::cos(angle), 0, std::sin(angle)}, 0.01));
  }
  system.particles().nail(system.particles().create(wheel, {0, 1, 0}, 1));
  for (const ParticleId hinge : rim) {
    const Vec3 at = system.particles().position(hinge);
    const BodyId link = system.bodies().create();
    const ParticleId top = system.particles().create(link, at, 0.01);
    system.particles().create(link, at + Vec3{0.01, -0.1, 0}, 0.02);
    (void)system.edits().combine(hinge, top);
  }
}

TEST(Body, tells_the_bodies_of_its_articulate_in_order) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 4});
  const BodyId lone = system.bodies().create();
  EXPECT_EQ(system.bodies().articulate_of(system.particles().body(chain.lower[2])).size(), 4u);
  EXPECT_TRUE(std::ranges::is_sorted(system.bodies().articulate_of(system.particles().body(chain.lower[0])), {},
                                     &BodyId::slot));
  EXPECT_EQ(system.bodies().articulate_of(lone), std::vector{lone});
}

TEST(Body, of_a_thousand_hinges_stays_exact) {
  System system;
  make_carousel(system, 1000);
  EXPECT_EQ(system.bodies().articulate_count(), 1u);
  run(system, 0.1);
}

TEST(Body, of_twice_as_many_hinges_costs_twice_the_memory_and_as_many_iterations) {
  struct Cost {
    double bytes;
    int iterations;
  };
  const auto cost_of = [](int pendulums) {
    System system;
    make_carousel(system, pendulums);
    const long before = allocated_bytes;
    int iterations = system.step(1.0 / 120).iterations_max;  // analyzes the structure: the factors and all lists
    const auto bytes = static_cast<double>(allocated_bytes - before);
    for (int i = 0; i < 5; ++i) iterations += system.step(1.0 / 120).iterations_max;
    return Cost{bytes, iterations};
  };
  const Cost half = cost_of(400), whole = cost_of(800);
  // If the hinges of one body were coupled to each other, the matrix would grow fourfold.
  EXPECT_LT(whole.bytes, 2.3 * half.bytes);
  EXPECT_LE(whole.iterations, half.iterations + 6);
}

TEST(Nail, holds_still_and_tells_its_force) {
  System system;
  const BodyId rod = system.bodies().create();
  const ParticleId top = system.particles().create(rod, {0, 0, 0}, 1);
  system.particles().create(rod, {0, -1, 0}, 2);
  system.particles().nail(top);
  run(system, 0.5);
  EXPECT_NEAR(norm(system.particles().position(top)), 0, 1e-9);
  EXPECT_NEAR(system.particles().nail_force(top).y, 3 * 9.81, 1e-4);
}

TEST(Nail, of_a_lone_particle_carries_its_weight) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 1, 0}, 2);
  system.particles().nail(p);
  (void)system.step(1.0 / 120);
  EXPECT_NEAR(system.particles().nail_force(p).y, 2 * 9.81, 1e-5);
}

TEST(ScriptedBond, comes_back_with_its_function_when_a_snapshot_is_restored) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {2, 0, 0});
  const BondId bond = system.bonds().create(p, q, ScriptedLaw{[](const BondState&) { return Vec3{1, 0, 0}; }});
  const Snapshot snapshot = system.snapshot();
  system.bonds().destroy(bond);
  (void)system.step(0.1);
  EXPECT_EQ(system.particles().velocity(p).x, 0);
  system.restore(snapshot);
  EXPECT_TRUE(system.step(0.1).warnings.empty());
  EXPECT_NEAR(system.particles().velocity(p).x, 0.1, 1e-12);
}

TEST(Nail, that_moves_carries_the_chain_along_and_does_work) {
  System system{SystemOptions{.damping = 1}};
  const auto chain = scenes::make_chain(system, {.links = 6, .direction = {0, -1, 0}});
  for (int i = 1; i <= 240; ++i) {
    const double t = i / 120.0;
    system.particles().nail(chain.upper[0], {0.3 * std::sin(3 * t), 0.3 * std::sin(2 * t), 0});
    ASSERT_LT(system.step(1.0 / 120).worst_gap, 1e-9);
    ASSERT_NEAR(
        norm(system.particles().position(chain.upper[0]) - Vec3{0.3 * std::sin(3 * t), 0.3 * std::sin(2 * t), 0}), 0,
        1e-9);
  }
  EXPECT_NE(system.energy().external_work, 0);
  system.particles().release(chain.upper[0]);
  (void)system.step(1.0 / 120);
  EXPECT_EQ(system.particles().nail_force(chain.upper[0]), Vec3{});
}

TEST(Spring, oscillates_with_its_own_period) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId anchor = system.particles().create(system.bodies().create(), {0, 0, 0});
  const ParticleId mass = system.particles().create(system.bodies().create(), {1.1, 0, 0}, 2);
  system.particles().nail(anchor);
  system.bonds().create(anchor, mass, SpringLaw{.stiffness = 50, .length = 1});
  const double period = 2 * std::numbers::pi * std::sqrt(2.0 / 50), dt = period / 500, energy = system.energy().total();
  for (int i = 0; i < 500; ++i) (void)system.step(dt);
  EXPECT_NEAR(system.particles().position(mass).x, 1.1, 1e-4);
  EXPECT_NEAR(system.energy().total(), energy, 1e-9);
  for (int i = 0; i < 250; ++i) (void)system.step(dt);
  EXPECT_NEAR(system.particles().position(mass).x, 0.9, 1e-4);
}

TEST(Spring, with_critical_damping_creeps_home_however_short_the_step) {
  // A stopping test in meters let slow motion stop short of home, the farther the shorter the step.
  const double mass = 2, omega = std::sqrt(20);
  for (const double dt : {1.0 / 240, 1.0 / 3840}) {
    System system{SystemOptions{.gravity = {}}};
    const ParticleId anchor = system.particles().create(system.bodies().create(), {0, 0, 0});
    const ParticleId end = system.particles().create(system.bodies().create(), {1.1, 0, 0}, mass);
    system.particles().nail(anchor);
    system.bonds().create(anchor, end,
                          SpringLaw{.stiffness = mass * omega * omega, .damping = 2 * mass * omega, .length = 1});
    const int steps = static_cast<int>(std::lround(3 / dt));
    for (int i = 1; i <= steps; ++i) {
      (void)system.step(dt);
      const double t = i * dt;
      ASSERT_NEAR(system.particles().position(end).x, 1 + 0.1 * std::exp(-omega * t) * (1 + omega * t), 0.16 * dt * dt)
          << t;
    }
  }
}

TEST(Spring, of_any_stiffness_is_stable_between_two_chains) {
  for (const double stiffness : {1.0, 1e3, 1e6, 1e9}) {
    System system;
    const auto a = scenes::make_chain(system, {.links = 5});
    const auto b = scenes::make_chain(system, {.links = 5, .top = {0, -0.2, 0.1}});
    system.bonds().create(a.lower[4], b.lower[4], SpringLaw{.stiffness = stiffness, .damping = 0.1});
    EXPECT_EQ(system.bodies().articulate_count(), 2u) << "bonds do not join articulates";
    const double start = system.energy().total();
    double kinetic = 0;
    for (int i = 0; i < 120; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_LT(report.worst_gap, 1e-8) << stiffness;
      ASSERT_LE(report.energy.total(), start + 1e-6) << stiffness;
      kinetic = std::max(kinetic, report.energy.kinetic);
    }
    EXPECT_GT(kinetic, 1) << "it swings";
  }
}

TEST(Drag, brings_relative_motion_to_rest_and_keeps_momentum) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1, {2, 0, 0});
  const ParticleId q = system.particles().create(system.bodies().create(), {0, 1, 0}, 3);
  system.bonds().create(p, q, DragLaw{1.0});
  for (int i = 0; i < 1200; ++i) (void)system.step(1.0 / 120);
  EXPECT_NEAR(system.particles().velocity(p).x, 0.5, 1e-4);
  EXPECT_NEAR(system.particles().velocity(q).x, 0.5, 1e-4);
  EXPECT_NEAR(system.momentum().x, 2, 1e-11);
}

TEST(ScriptedBond, acts_on_both_ends_and_sees_the_state) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {2, 0, 0});
  int calls = 0;
  system.bonds().create(p, q,
                        ScriptedLaw{[&](const BondState& s) {
                                      ++calls;
                                      return 0.5 * (s.position_q - s.position_p);
                                    },
                                    "pull"});
  (void)system.step(0.1);
  EXPECT_EQ(calls, 1);
  EXPECT_NEAR(system.momentum().x, 0, 1e-13);
  EXPECT_NEAR(system.particles().velocity(p).x, 0.1, 1e-12);
}

TEST(ScriptedBond, that_throws_or_returns_nan_is_switched_off_and_named) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {2, 0, 0});
  const BondId bad = system.bonds().create(p, q, ScriptedLaw{[](const BondState&) { return Vec3{nan, 0, 0}; }, "wild"});
  const BondId thrower = system.bonds().create(
      p, q, ScriptedLaw{[](const BondState&) -> Vec3 { throw std::runtime_error("no such wind"); }, "wind"});
  const StepReport report = system.step(0.01);
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_NE(report.warnings[0].find("wild"), std::string::npos);
  EXPECT_NE(report.warnings[1].find("no such wind"), std::string::npos);
  EXPECT_FALSE(system.bonds().is_active(bad));
  EXPECT_FALSE(system.bonds().is_active(thrower));
  EXPECT_TRUE(system.step(0.01).warnings.empty()) << "the world goes on";
}

TEST(ScriptedBond, may_ask_for_edits_which_come_right_after_the_step) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 3});
  const ParticleId other = system.particles().create(system.bodies().create(), {5, 5, 5});
  bool asked = false, refused = false;
  system.bonds().create(other, chain.lower[2], ScriptedLaw{[&](const BondState&) {
                          if (!asked) {
                            EXPECT_TRUE(system.edits().separate(chain.lower[0], chain.upper[1]).queued);
                            EXPECT_EQ(system.bodies().articulate_count(), 2u);
                            try {
                              system.bodies().create();
                            } catch (const std::logic_error&) {
                              refused = true;
                            }
                          }
                          asked = true;
                          return Vec3{};
                        }});
  (void)system.step(0.01);
  EXPECT_TRUE(refused);
  EXPECT_EQ(system.bodies().articulate_count(), 3u);
}

TEST(Grip, pulls_a_link_towards_its_target_and_lets_go) {
  System system{SystemOptions{.damping = 0.5}};
  const auto chain = scenes::make_chain(system, {.links = 24, .direction = {0, -1, 0}});
  run(system, 0.2);
  const Vec3 target{0.8, -1.2, 0.5};
  const GripId grip = system.grips().create(chain.links[20], {0, 0, 0}, target);
  run(system, 3);
  EXPECT_LT(norm(system.bodies().center_of_mass(chain.links[20]) - target), 0.1);
  const PoseSnapshot poses = system.viewer().poses();
  ASSERT_EQ(poses.holds.size(), 1u);
  EXPECT_GT(poses.holds[0].force, 1);
  system.grips().destroy(grip);
  run(system, 5);
  EXPECT_GT(norm(system.bodies().center_of_mass(chain.links[20]) - target), 0.5) << "it swings back";
}

TEST(Grip, of_two_holders_adds_up) {
  const auto rest = [](int holders) {
    System system{SystemOptions{.damping = 4}};
    const BodyId body = system.bodies().create();
    system.particles().create(body, {0, 0, 0}, 1);
    for (int i = 0; i < holders; ++i) (void)system.grips().create(body, {}, {0, 0, 0}, {.client = std::uint32_t(i)});
    for (int i = 0; i < 2000; ++i) (void)system.step(1.0 / 120);
    return -system.particles().position(system.particles().ids()[0]).y;
  };
  EXPECT_NEAR(rest(1) / rest(2), 2, 1e-6);
}

TEST(Grip, neither_shoots_a_light_thing_nor_a_heavy_one) {
  for (const double mass : {1e-6, 1.0, 1e6}) {
    System system;
    const BodyId body = system.bodies().create();
    const ParticleId p = system.particles().create(body, {0, 0, 0}, mass);
    (void)system.grips().create(body, {}, {5, 0, 0});
    double farthest = 0;
    for (int i = 0; i < 600; ++i) {
      (void)system.step(1.0 / 60);
      farthest = std::max(farthest, system.particles().position(p).x);
    }
    EXPECT_LT(farthest, 5.6) << mass;
    EXPECT_NEAR(system.particles().position(p).x, 5, 0.05) << mass;
  }
}

TEST(Grip, survives_the_cut_and_the_merge_of_its_body) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 6});
  const GripId grip = system.grips().create(chain.links[4], {}, {0.3, 0.3, 0});
  run(system, 0.1);
  (void)system.edits().separate(chain.lower[2], chain.upper[3]);
  run(system, 0.1);
  (void)system.edits().combine(chain.links[3], chain.links[4]);
  run(system, 0.1);
  EXPECT_TRUE(system.grips().contains(grip));
  system.bodies().destroy(chain.links[3]);
  EXPECT_FALSE(system.grips().contains(grip)) << "nothing left to hold";
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}

TEST(Damping, is_exponential_in_time_whatever_the_step) {
  for (const double dt : {0.001, 0.01, 0.1}) {
    System system{SystemOptions{.gravity = {}, .damping = 0.3}};
    const BodyId body = system.bodies().create({.damping = 0.2});
    const ParticleId p = system.particles().create(body, {}, 1, {1, 0, 0});
    for (int i = 0; i < std::lround(2 / dt); ++i) (void)system.step(dt);
    EXPECT_NEAR(system.particles().velocity(p).x, std::exp(-1), 1e-10);
    EXPECT_NEAR(system.energy().dissipated, 0.5 - 0.5 * std::exp(-2), 1e-10);
  }
}

TEST(Kinds, static_scripted_and_inactive_bodies_do_as_they_say) {
  System system;
  const BodyId fixed = system.bodies().create({.kind = BodyKind::static_}),
               puppet = system.bodies().create({.kind = BodyKind::scripted}),
               absent = system.bodies().create({.kind = BodyKind::inactive}), hanging = system.bodies().create();
  const ParticleId f = system.particles().create(fixed, {0, 0, 0}), s = system.particles().create(puppet, {1, 0, 0}),
                   i = system.particles().create(absent, {2, 0, 0});
  const ParticleId top = system.particles().create(hanging, {0, 0, 0}),
                   end = system.particles().create(hanging, {0.5, 0, 0});
  (void)system.edits().combine(f, top);
  for (int k = 1; k <= 60; ++k) {
    system.particles().set_position(s, {1, k / 60.0, 0});
    ASSERT_LT(system.step(1.0 / 60).worst_gap, 1e-9);
  }
  EXPECT_NEAR(norm(system.particles().position(f)), 0, 1e-9);
  EXPECT_NEAR(system.particles().position(s).y, 1, 1e-9);
  EXPECT_EQ(system.particles().position(i), (Vec3{2, 0, 0}));
  EXPECT_LT(system.particles().position(end).y, -0.1);
  EXPECT_EQ(system.viewer().poses().bodies.size(), 3u) << "inactive bodies are not drawn";
}

TEST(EnergyBook, adds_up_through_hands_nails_springs_damping_and_edits) {
  for (const auto mode : {IntegrationMode::energy_keeping, IntegrationMode::robust}) {
    System system{SystemOptions{.mode = mode, .damping = 0.2}};
    const auto chain = scenes::make_chain(system, {.links = 12});
    const auto other = scenes::make_chain(system, {.links = 4, .nailed = false, .top = {0, 0.5, 0}});
    system.bonds().create(chain.lower[5], other.lower[3], SpringLaw{.stiffness = 30, .damping = 0.2});
    system.bonds().create(chain.lower[8], other.lower[0],
                          ScriptedLaw{[](const BondState& s) { return 0.3 * (s.position_q - s.position_p); }});
    const auto book = [&] {
      const Energy e = system.energy();
      return e.balance();
    };
    const double start = book();
    GripId grip;
    for (int i = 0; i < 360; ++i) {
      if (i > 40 && i < 200) system.particles().nail(chain.upper[0], {0.2 * std::sin(0.05 * (i - 40)), 0, 0});
      if (i == 60) grip = system.grips().create(chain.links[9], {}, {0.4, 0.2, 0.3});
      if (i == 120) system.grips().move(grip, {-0.4, 0.2, 0});
      if (i == 180) (void)system.edits().separate(chain.lower[3], chain.upper[4]);
      if (i == 220) (void)system.edits().combine(chain.lower[3], chain.upper[4], 0.2);
      if (i == 280) system.particles().set_velocity(chain.lower[11], {0, 0, 3});
      if (i == 300) system.grips().destroy(grip);
      (void)system.step(1.0 / 120);
      ASSERT_NEAR(book(), start, 1e-6) << "at step " << i;
    }
    EXPECT_GT(system.energy().dissipated, 0.01);
    EXPECT_NE(system.energy().edits, 0);
  }
}

TEST(Conflict, of_two_nails_too_far_apart_is_shared_reported_and_finite) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 10});
  system.particles().nail(chain.lower.back(), {1.2, 0, 0});  // the chain is 1 m long
  for (int i = 0; i < 240; ++i) {
    const StepReport report = system.step(1.0 / 120);
    ASSERT_EQ(report.unconverged, 1);
    ASSERT_TRUE(std::isfinite(report.energy.total()));
    ASSERT_LT(report.energy.kinetic, 10);
  }
  double shortest = 1, longest = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    const double length =
        norm(system.particles().position(chain.lower[i]) - system.particles().position(chain.upper[i]));
    shortest = std::min(shortest, length), longest = std::max(longest, length);
  }
  EXPECT_LT(longest - shortest, 0.02) << "the violation is shared";
  system.particles().release(chain.lower.back());
  (void)system.step(1.0 / 120);
  double kinetic = 0;
  for (int i = 0; i < 60; ++i) {
    const StepReport report = system.step(1.0 / 120);
    EXPECT_EQ(report.unconverged, 0);
    EXPECT_LT(report.worst_gap, 1e-9);
    kinetic = std::max(kinetic, report.energy.kinetic);
  }
  EXPECT_LT(kinetic, 20) << "letting go must not shoot";
}

TEST(Extended, taut_chain_between_two_nails_at_exactly_its_length_survives) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 10});
  system.particles().nail(chain.lower.back());
  for (int i = 0; i < 120; ++i) {
    const StepReport report = system.step(1.0 / 60);
    ASSERT_TRUE(std::isfinite(report.energy.total()));
    ASSERT_LT(report.worst_gap, 1e-4);
  }
}

TEST(BadInput, is_refused_with_the_condition_and_the_value_and_changes_nothing) {
  System system;
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {}), q = system.particles().create(body, {1, 0, 0});
  const auto hash = system.state_hash();
  const auto refused = [&](auto action, const char* mentions) {
    try {
      action();
      ADD_FAILURE() << "accepted: " << mentions;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(mentions), std::string::npos) << error.what();
    }
  };
  refused([&] { system.particles().create(body, {nan, 0, 0}); }, "position must be finite");
  refused([&] { system.particles().create(body, {0, infinite, 0}); }, "position must be finite");
  refused([&] { system.particles().create(body, {0, 1e300, 0}); }, "1e9");
  refused([&] { system.particles().create(system.bodies().create(), {}, 0); }, "yet to be made");
  refused([&] { system.particles().create(body, {0.5, 0.1, 0}, 0); }, "do not reach");
  refused([&] { system.particles().create(body, {}, -2); }, "got -2");
  refused([&] { system.particles().create(body, {}, nan); }, "mass");
  refused([&] { system.particles().create(body, {}, 1e300); }, "1e15");
  refused([&] { system.particles().create(body, {}, 1, {nan, 0, 0}); }, "velocity");
  refused([&] { system.particles().set_position(p, {nan, 0, 0}); }, "position");
  refused([&] { system.particles().set_mass(p, -1); }, "mass");
  refused([&] { system.particles().apply_force(p, {infinite, 0, 0}); }, "force");
  refused([&] { system.set_gravity({0, nan, 0}); }, "gravity");
  refused([&] { system.set_damping(-1.0); }, "damping");
  refused([&] { (void)system.step(0); }, "dt");
  refused([&] { (void)system.step(-0.1); }, "dt");
  refused([&] { (void)system.step(nan); }, "dt");
  refused([&] { system.bonds().create(p, p, SpringLaw{}); }, "twice");
  refused([&] { system.bonds().create(p, q, SpringLaw{-1}); }, "stiffness");
  refused([&] { system.bonds().create(p, q, SpringLaw{infinite}); }, "stiffness");
  refused([&] { system.bonds().create(p, q, ScriptedLaw{}); }, "function");
  refused([&] { (void)system.edits().combine(p, q, nan); }, "over");
  refused([&] { (void)system.edits().combine(ParticleId{}, q); }, "null");
  refused([&] { system.bodies().set_rod(system.bodies().create(), 1, 1); }, "exactly two");
  refused([&] { (void)system.grips().create(body, {nan, 0, 0}, {}); }, "local_point");
  refused([&] { system.particles().nail(p, {nan, 0, 0}); }, "position");
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
  (void)hash;
}

TEST(StaleIds, name_their_successor) {
  System system;
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  const ParticleId p = system.particles().create(a, {}), q = system.particles().create(b, {});
  (void)system.edits().combine(p, q);
  (void)system.edits().combine(p, q);
  const auto text = [&](auto action) {
    try {
      action();
    } catch (const StaleIdError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(text([&] { (void)system.particles().position(q); }).find("absorbed by particle 0"), std::string::npos);
  EXPECT_NE(text([&] { (void)system.bodies().mass(b); }).find("absorbed by body 0"), std::string::npos);
  system.bodies().destroy(a);
  EXPECT_NE(text([&] { (void)system.particles().position(p); }).find("destroyed"), std::string::npos);
  const ParticleId reused = system.particles().create(system.bodies().create(), {});
  EXPECT_EQ(reused.slot, p.slot) << "slots are reused";
  EXPECT_NE(text([&] { (void)system.particles().position(p); }).find("destroyed"), std::string::npos)
      << "but old ids stay dead";
}

}  // namespace
}  // namespace iota
