// SPDX-License-Identifier: Apache-2.0
#include "island/free_bodies.h"

#include "system/core.h"
#include "tests/cpp/modes.h"
#include "tests/cpp/scattered.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace iota::island {
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

/// Loose bodies at random: solids, rods (some with a spin), plates and rigid sets of up to nine particles.
void scatter_bodies(System& system, std::mt19937& random, int count) {
  const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  const auto vector = [&] { return Vec3{number(), number(), number()}; };
  const auto power = [&](double lowest, double highest) {
    return std::pow(10, 0.5 * (lowest + highest) + 0.5 * (highest - lowest) * number());
  };
  const double far = power(-1, 7);
  for (int i = 0; i < count; ++i) {
    const double size = power(-2, 2), mass = power(-6, 6);
    const Vec3 place = far * vector();
    const int points = static_cast<int>(random() % 10);
    BodyId body;
    if (points < 2) {
      body = system.bodies().create(Box{size * Vec3{1, 0.5 + 0.4 * number(), 0.5 + 0.4 * number()}},
                                    {.mass = mass, .position = place, .velocity = vector()});
    } else {
      body = system.bodies().create();
      for (int p = 0; p < points; ++p)
        system.particles().create(body, place + size * vector(), mass * (0.6 + 0.4 * number()), Vec3{});
      if (points == 2) system.bodies().set_rod(body, mass, 0.1 * size);
    }
    system.bodies().set_angular_velocity(body, 100 * number() * vector());
    if (random() % 4 == 0) system.bodies().set_damping(body, 0.5);
  }
}

/// A model that is stepped by its parts. `own`: each loose body has an island of its own, kept from step to step.
struct Flight {
  Core core;
  bool own;
  std::map<std::uint32_t, std::unique_ptr<Island>> islands = {};
  std::vector<solver::AdvanceReport> reports = {};

  Flight(const Snapshot& start, bool own, int threads = 1) : core{.parallel = Parallel(threads)}, own(own) {
    core.editor.restore(start);
  }
  void step(double h) {
    model::Model& model = core.model;
    (void)core.islands.update(model, core.parallel);
    core.islands.wake_stirred(model, 0.01);
    const std::size_t islands_awake = core.islands.awake(model).size();
    const auto loose = core.islands.loose(model);
    core.parallel.for_each(islands_awake + loose.size(), 1, [&](std::size_t i) {
      if (i < islands_awake || !own) core.islands.advance(model, i, h, Island::Clock::time_point::max());
    });
    reports.clear();
    for (const FreeBodies::Loose& body : loose) {
      if (own) step_own(body.articulate, h);
      reports.push_back(own ? islands.at(body.articulate)->latest() : body.report);
    }
    if (model.corrections.lacks_room()) model.corrections.make_room(model.rings.slot_count());
    (void)core.islands.free_bodies().advance(model, h, core.parallel);
    if (own) core.islands.free_bodies().note_change();  // it has not seen which fell asleep
    ingredient::end_step(model, h);
    model.time += h, model.last_dt = h, ++model.step;
  }
  void step_own(std::uint32_t articulate, double h) {
    std::unique_ptr<Island>& island = islands[articulate];
    if (!island) {
      std::vector<std::uint32_t> node_of_ring(core.model.rings.slot_count(), model::none);
      island = std::make_unique<Island>();
      island->assemble(core.model, {&articulate, 1}, node_of_ring);
    }
    island->try_step(core.model, h);
    (void)island->commit(core.model, h);
  }
  std::uint64_t bits() { return core.model.hash(); }
};

TEST(LooseBodies, move_as_if_each_had_an_island_of_its_own_to_the_bit) {
  std::mt19937 random(7);
  for (const IntegrationMode mode : all_modes)
    for (int round = 0; round < 12; ++round) {
      SCOPED_TRACE("mode " + std::to_string(static_cast<int>(mode)) + ", round " + std::to_string(round));
      System system({.gravity = round % 2 ? Vec3{} : Vec3{0, 0, -9.81}, .mode = mode, .damping = round % 3 ? 0 : 0.3});
      scatter_bodies(system, random, 12);
      const std::vector<ParticleId> particles = system.particles().ids();
      for (int i = 0; i < 5; ++i) system.particles().apply_force(particles[random() % particles.size()], {1, -2, 3});
      const Snapshot start = system.snapshot();
      const auto own = std::make_unique<Flight>(start, true), lent = std::make_unique<Flight>(start, false),
                 threaded = std::make_unique<Flight>(start, false, 3);
      for (const double h : {1.0 / 120, 1e-4, 1.0 / 60, 0.1, 1.0 / 60}) {
        for (Flight* const flight : {own.get(), lent.get(), threaded.get()}) flight->step(h);
        ASSERT_EQ(own->reports.size(), 12u);
        ASSERT_EQ(lent->bits(), own->bits()) << h;
        ASSERT_EQ(threaded->bits(), own->bits()) << h;
        for (std::size_t i = 0; i < own->reports.size(); ++i) {
          ASSERT_EQ(lent->reports[i].iterations, own->reports[i].iterations);
          ASSERT_EQ(lent->reports[i].lost, own->reports[i].lost);
          ASSERT_EQ(lent->reports[i].converged, own->reports[i].converged);
        }
      }
    }
}

TEST(LooseBodies, fall_asleep_and_wake_as_if_each_had_an_island_of_its_own) {
  for (const IntegrationMode mode : all_modes) {
    System system({.gravity = {}, .mode = mode, .damping = 1, .rest = {.after = 0.1, .speed = 0.1}});
    std::mt19937 random(3);
    for (int i = 0; i < 20; ++i) {
      const BodyId box = system.bodies().create(Box{{1, 2, 3}}, {.position = {5.0 * i, 0, 0}});
      system.bodies().set_angular_velocity(box, {0, 0, 0.02 * i});
    }
    const auto own = std::make_unique<Flight>(system.snapshot(), true),
               lent = std::make_unique<Flight>(system.snapshot(), false);
    std::vector<std::uint32_t> resting;
    for (int i = 0; i < 100; ++i) {
      own->step(0.02), lent->step(0.02);
      ASSERT_EQ(lent->bits(), own->bits()) << "step " << i;
      (void)lent->core.islands.awake(lent->core.model);
      resting.push_back(lent->core.islands.resting(lent->core.model));
    }
    EXPECT_GT(resting[10], 0u);
    EXPECT_LT(resting[10], 20u);
    EXPECT_EQ(resting.back(), 20u);
  }
}

// The only loose body finds the island that it had in the last step.
TEST(LooseBodies, of_which_there_is_one_fall_asleep_and_wake_as_if_it_had_an_island_of_its_own) {
  for (const IntegrationMode mode : all_modes) {
    System system({.gravity = {}, .mode = mode, .damping = 3, .rest = {.after = 0.1, .speed = 0.1}});
    const BodyId box = system.bodies().create(Box{{1, 2, 3}});
    system.bodies().set_angular_velocity(box, {0, 0.1, 0.2});
    const auto own = std::make_unique<Flight>(system.snapshot(), true),
               lent = std::make_unique<Flight>(system.snapshot(), false);
    int falls = 0;
    for (int i = 0; i < 240; ++i) {
      for (Flight* const flight : {own.get(), lent.get()}) {
        model::Model& model = flight->core.model;
        if (i % 90 == 70) model.pushes.make(model.particles[model.bodies[box.slot].first].ring).force = {0, 3e5, 0};
        flight->step(0.02);
      }
      ASSERT_EQ(lent->bits(), own->bits()) << "step " << i;
      const bool rests = lent->core.model.bodies[box.slot].kind == BodyKind::resting;
      const auto loose = lent->core.islands.free_bodies().loose();
      falls += !loose.empty() && loose[0].rests;
      EXPECT_EQ(rests, loose.empty() || loose[0].rests);
    }
    EXPECT_EQ(falls, 3);
  }
}

TEST(LooseBodies, report_their_steps_as_islands) {
  System system({.rest = {.after = 0.1, .speed = 0.1}});
  std::vector<BodyId> boxes;
  for (int i = 0; i < 3; ++i) boxes.push_back(system.bodies().create(Box{{1, 1, 1}}, {.position = {3.0 * i, 0, 0}}));
  for (int i = 0; i < 2; ++i) system.bodies().set_angular_velocity(boxes[i], {1, 2, 3});
  EXPECT_TRUE(system.islands().empty());
  system.bodies().set_kind(boxes[1], BodyKind::resting);
  (void)system.step(0.01);
  const std::vector<IslandReport> reports = system.islands();
  ASSERT_EQ(reports.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(reports[i].bodies, std::vector{boxes[i]});
    EXPECT_EQ(reports[i].points, 4u);
    EXPECT_EQ(reports[i].resting, i == 1);
    EXPECT_EQ(reports[i].substeps, i == 1 ? 0 : 1);
    EXPECT_LT(reports[i].gap, 1e-12);
  }
  EXPECT_GT(reports[0].iterations, 0);
  system.bodies().destroy(boxes[0]);
  EXPECT_EQ(system.islands().size(), 2u);
}

TEST(LooseBodies, frozen_ones_have_the_energy_that_they_have_after_each_change) {
  System system;
  std::vector<BodyId> boxes;
  for (int i = 0; i < 40; ++i)
    boxes.push_back(system.bodies().create(Box{}, {.position = {2.0 * i, 0, 0}, .velocity = {0, 0.1 * i, 0}}));
  const auto step_and_compare = [&] {
    const StepReport report = system.step(0.01);
    ASSERT_NEAR(report.energy.kinetic, system.energy().kinetic, 1e-10);
    ASSERT_NEAR(report.energy.potential, system.energy().potential, 1e-10);
  };
  const auto run = [&] {
    for (int i = 0; i < 3; ++i) step_and_compare();
  };
  run();
  for (std::size_t i = 2; i < boxes.size(); ++i) system.bodies().set_stride(boxes[i], 0);
  run();
  system.bodies().set_velocity(boxes[7], {3, 0, 0});
  run();
  system.bodies().apply_force(boxes[8], {50, 0, 0});
  run();
  system.bodies().set_stride(boxes[9], 1);
  run();
  system.bodies().set_stride(boxes[9], 0);
  run();
  system.bodies().set_pose(boxes[10], {0, 7, 0}, {});
  run();
  system.set_gravity({0, -3, 0});
  run();
  const Snapshot snapshot = system.snapshot();
  step_and_compare();
  const std::uint64_t hash = system.state_hash();
  System other;
  other.restore(snapshot);
  (void)other.step(0.01);
  EXPECT_EQ(other.state_hash(), hash);
}

TEST(LooseBodies, are_tied_held_and_parted_and_keep_energy_and_the_bits_of_a_snapshot) {
  System system;
  std::mt19937 random(9);
  std::vector<ParticleId> corners;
  for (int i = 0; i < 6; ++i) {
    const BodyId box =
        system.bodies().create(Box{{1, 1, 1}}, {.position = {1.5 * i, 0, 0}, .attachments = {{0.5, 0.5, 0.5}}});
    system.bodies().set_angular_velocity(box, {0.3 * i, 1, 2});
    corners.push_back(system.bodies().attachments(box)[0]);
  }
  std::vector<BondId> bonds;
  std::vector<GripId> grips;
  for (int round = 0; round < 40; ++round) {
    switch (random() % 4) {
      case 0:
        bonds.push_back(system.bonds().create(corners[random() % 3], corners[3 + random() % 3], SpringLaw{}));
        break;
      case 1:
        grips.push_back(system.grips().create(system.particles().body(corners[random() % 6]), {}, {0, 1, 0}));
        break;
      case 2:
        if (!bonds.empty()) system.bonds().destroy(bonds.back()), bonds.pop_back();
        break;
      default:
        if (!grips.empty()) system.grips().destroy(grips.back()), grips.pop_back();
    }
    const Snapshot saved = system.snapshot();
    const double start = system.energy().balance();
    const auto run = [&] {
      for (int i = 0; i < 4; ++i)
        ASSERT_NEAR(system.step(1.0 / 120).energy.balance(), start, 1e-6 * std::abs(start) + 1e-6);
    };
    run();
    ASSERT_EQ(system.validate(), std::vector<std::string>{});
    const std::uint64_t hash = system.state_hash();
    system.restore(saved);
    run();
    ASSERT_EQ(system.state_hash(), hash) << round;
  }
}

}  // namespace
}  // namespace iota::island
