// SPDX-License-Identifier: Apache-2.0
// Forces that are held have potential energy like those that are solved for, and the energy book closes with them.
#include "energy_book.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota {
namespace {

void expect_same(const Energy& a, const Energy& b) {
  EXPECT_EQ(a.kinetic, b.kinetic);
  EXPECT_EQ(a.potential, b.potential);
  EXPECT_NEAR(a.external_work, b.external_work, 1e-12);
  EXPECT_NEAR(a.edits, b.edits, 1e-12);
}

/// Some particles and a rod, each of which is drawn and pushed by everything that has an energy.
struct Swarm {
  System system;
  std::vector<ParticleId> points;
  PairsId pairs;
  FieldId well;
  BondId bond;

  explicit Swarm(IntegrationMode mode = IntegrationMode::energy_keeping) : system({.gravity = {}, .mode = mode}) {
    std::mt19937 random(3);
    const auto number = [&] { return static_cast<double>(random() >> 8) * 0x1p-24 - 0.5; };
    for (int i = 0; i < 27; ++i) {
      const Vec3 place{i % 3 + 0.1 * number(), i / 3 % 3 + 0.1 * number(), i / 9 + 0.1 * number()};
      points.push_back(
          system.particles().create(system.bodies().create(), place, 1 + number(), {number(), number(), number()}));
    }
    const BodyId rod = system.bodies().create();
    points.push_back(system.particles().create(rod, {5, 0, 0}));
    points.push_back(system.particles().create(rod, {6, 0, 0}));
    pairs = system.pairs().create({system.laws().find("coulomb"), {{"strength", 0.3}, {"softening", 0.2}}, {}},
                                  {.cutoff = 50});
    well = system.fields().create("well", {.parameters = {{"center_x", 1}, {"strength", 3}, {"softening", 1}}});
    system.fields().create("attractor", {.parameters = {{"strength", 0.7}, {"range", 3}}});
    system.fields().create("energy = 0.5*k*(x^2 + 2*y^2) + m*g*z; fx = -0*vx",
                           {.parameters = {{"k", 0.4}, {"g", 0.3}}});
    bond = system.bonds().create(points[0], points[27],
                                 SharedLaw{system.laws().find("spring"), {{"stiffness", 2}, {"length", 1}}, false});
  }
  Energy step(double h) {
    const StepReport report = system.step(h);
    EXPECT_TRUE(report.warnings.empty());
    expect_same(report.energy, system.energy());
    return report.energy;
  }
};

TEST(HeldEnergy, is_potential_and_is_kept) {
  Swarm swarm;
  const Energy start = swarm.system.energy();
  EXPECT_EQ(start.external_work, 0);
  double most = 0, least_potential = start.potential, drift = 0;
  for (int i = 0; i < 1000; ++i) {
    const Energy e = swarm.step(0.002);
    most = std::max(most, std::abs(e.potential - start.potential));
    least_potential = std::min(least_potential, e.potential);
    drift = std::max(drift, std::abs(e.total() - start.total()));
    ASSERT_NEAR(book(e), book(start), 1e-10 * std::abs(start.total()));
    ASSERT_NEAR(e.external_work, e.total() - start.total(), 1e-9) << "the error of holding";
  }
  EXPECT_GT(most, 5) << "a lot goes to and fro";
  EXPECT_LT(drift, 2e-4 * most) << "and next to nothing is lost";
}

TEST(HeldEnergy, errors_are_of_second_order) {
  double errors[2];
  for (const int half : {0, 1}) {
    Swarm swarm;
    const double start = swarm.system.energy().total(), h = 0.008 / (1 + half);
    for (int i = 0; i < 100 * (1 + half); ++i) (void)swarm.step(h);
    errors[half] = std::abs(swarm.system.energy().total() - start);
  }
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.8);
}

TEST(HeldEnergy, equals_its_closed_form) {
  System system{{.gravity = {0, -2, 0}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {3, 4, 0}, 2);
  const ParticleId q = system.particles().create(system.bodies().create(), {0, 0, 12}, 3);
  const double gravity = 2 * 2 * 4.0;
  EXPECT_DOUBLE_EQ(system.energy().potential, gravity);
  const FieldId uniform =
      system.fields().create("uniform", {.parameters = {{"acceleration_x", -5}}, .replaces_gravity = true});
  EXPECT_DOUBLE_EQ(system.energy().potential, 2 * 5 * 3) << "it replaces gravity";
  system.fields().set_active(uniform, false);
  EXPECT_DOUBLE_EQ(system.energy().potential, gravity);
  const FieldId well = system.fields().create("well", {.parameters = {{"strength", 7}, {"softening", 0}}});
  EXPECT_DOUBLE_EQ(system.energy().potential, gravity - 7 * (2 / 5.0 + 3 / 12.0));
  system.fields().destroy(well);
  system.pairs().create({system.laws().find("gravity"), {{"strength", 11}}, {}}, {.cutoff = 20});
  EXPECT_DOUBLE_EQ(system.energy().potential, gravity - 11 * 2 * 3 / 13.0);
  system.bonds().create(p, q, SharedLaw{system.laws().find("spring"), {{"stiffness", 4}, {"length", 10}}, false});
  EXPECT_DOUBLE_EQ(system.energy().potential, gravity - 11 * 2 * 3 / 13.0 + 0.5 * 4 * 9);
  EXPECT_NEAR(book(system.energy()), 0, 1e-12) << "all this was made by edits";
}

TEST(HeldEnergy, changes_by_edits_are_booked_as_edits) {
  for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    Swarm swarm(mode);
    System& s = swarm.system;
    const double start = book(s.energy());
    const auto check = [&](const char* what) {
      ASSERT_NEAR(book(s.energy()), start, 1e-9) << what;
      ASSERT_NEAR(book(swarm.step(0.002)), start, 1e-9) << what << ", and a step";
      ASSERT_TRUE(s.validate().empty());
    };
    check("nothing");
    s.particles().set_position(swarm.points[0], {9, 9, 9}), check("moved");
    s.particles().set_mass(swarm.points[1], 4), check("heavier");
    s.fields().set_parameter(swarm.well, "strength", 5), check("another parameter of a field");
    s.pairs().set_parameter(swarm.pairs, "strength", 0.1), check("another parameter of a pair");
    s.bonds().set_parameter(swarm.bond, "stiffness", 20), check("another parameter of a bond");
    s.fields().set_active(swarm.well, false), check("a field switched off");
    s.bonds().set_active(swarm.bond, false), check("a bond switched off");
    s.bonds().set_active(swarm.bond, true), check("and on");
    s.particles().create(s.bodies().create(), {2, -3, 0}), check("born");
    s.particles().destroy(swarm.points[3]), check("destroyed");
    (void)s.edits().combine(swarm.points[5], swarm.points[6]), check("combined");
    s.particles().nail(swarm.points[8]), check("nailed");
    s.set_gravity({1, -2, 3}), check("another gravity");
    s.bodies().set_kind(s.particles().body(swarm.points[9]), BodyKind::static_), check("static");
    s.bodies().set_kind(s.particles().body(swarm.points[10]), BodyKind::inactive), check("inactive");
    s.emitters().create({.rate = 400, .lifetime = 0.1, .mass = 0.1});
    for (int i = 0; i < 100; ++i) check("births and deaths");
    s.pairs().destroy(swarm.pairs), check("no pairs");
  }
}

TEST(HeldEnergy, is_part_of_the_change_by_a_batch_of_edits) {
  Swarm swarm;
  const double before = swarm.system.energy().total();
  swarm.system.edits().begin();
  swarm.system.particles().set_position(swarm.points[0], {9, 9, 9});
  const RestructureReport report = swarm.system.edits().end();
  EXPECT_NEAR(report.energy_change, swarm.system.energy().total() - before, 1e-12);
  EXPECT_GT(std::abs(report.energy_change), 1);
  EXPECT_TRUE(swarm.system.edits().undo());
  EXPECT_EQ(swarm.system.energy().total(), before);
}

TEST(HeldEnergy, is_the_same_to_the_bit_in_replay_and_after_restore) {
  Swarm swarm;
  swarm.system.record().start();
  for (int i = 0; i < 20; ++i) (void)swarm.step(0.002);
  swarm.system.particles().set_position(swarm.points[0], {4, 4, 4});
  for (int i = 0; i < 20; ++i) {
    (void)swarm.system.step(0.002);
    if (i % 3 == 0) (void)swarm.system.energy();  // looking changes nothing
    if (i == 7) swarm.system.fields().set_parameter(swarm.well, "strength", 2);
  }
  const Recording recording = swarm.system.record().stop();
  System other;
  EXPECT_EQ(other.record().replay(recording), std::nullopt);
  Swarm restored;
  restored.system.restore(swarm.system.snapshot());
  EXPECT_EQ(restored.system.energy().total(), swarm.system.energy().total());
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(restored.system.step(0.002).energy.external_work, swarm.system.step(0.002).energy.external_work);
    EXPECT_EQ(restored.system.state_hash(), swarm.system.state_hash());
  }
}

TEST(HeldEnergy, may_be_looked_at_from_a_force_and_is_then_that_of_the_start) {
  Swarm looked, plain;
  double seen = 0, of_pairs = 0;
  for (Swarm* s : {&looked, &plain})
    s->system.fields().create(FieldFunction([&, s](const ParticleBatch& batch) {
      std::fill_n(batch.force, 3 * batch.count, 0.0);
      if (s == &looked) seen = s->system.energy().potential, of_pairs = s->system.pairs().energy(s->pairs);
    }));
  for (int i = 0; i < 5; ++i) {
    const double start = looked.system.energy().potential, pairs = looked.system.pairs().energy(looked.pairs);
    (void)looked.system.step(0.002), (void)plain.system.step(0.002);
    EXPECT_EQ(seen, start);
    EXPECT_EQ(of_pairs, pairs);
    EXPECT_EQ(looked.system.state_hash(), plain.system.state_hash());
  }
}

}  // namespace
}  // namespace iota
