// SPDX-License-Identifier: Apache-2.0
// What random scenes have found: edits that left the energy book, momentum or a body's shape behind.
#include "energy_book.h"
#include "scenes/chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

namespace iota {
namespace {

struct Plate {
  System system{SystemOptions{.gravity = {}}};
  BodyId body = system.bodies().create();
  std::vector<ParticleId> points;
  Plate() {  // five points: the fifth is carried by the other four
    for (const Vec3& x : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0.3, 0.2, 0.1}})
      points.push_back(system.particles().create(body, x, 2));
  }
};

TEST(AssignedVelocity, of_a_carried_particle_keeps_its_momentum_and_the_book) {
  Plate plate;
  plate.system.particles().set_velocity(plate.points[4], {3, -1, 2});
  const Vec3 momentum = plate.system.momentum(), spin = plate.system.angular_momentum();
  const double before = book(plate.system);
  (void)plate.system.step(1e-3);
  EXPECT_LT(norm(plate.system.momentum() - momentum), 1e-12);
  EXPECT_LT(norm(plate.system.angular_momentum() - spin), 1e-12);
  EXPECT_NEAR(book(plate.system), before, 1e-12) << "what a rigid body cannot have of it is booked under edits";
  EXPECT_LT(plate.system.energy().edits - 0.5 * 2 * 14, -1);
}

TEST(EnergyBook, adds_up_when_masses_and_kinds_change) {
  Plate plate;
  for (const ParticleId p : plate.points) plate.system.particles().set_velocity(p, {1, 2, 0});
  (void)plate.system.step(1e-2);
  const double before = book(plate.system);
  plate.system.particles().set_mass(plate.points[1], 7);
  EXPECT_NEAR(book(plate.system), before, 1e-12);
  (void)plate.system.step(1e-2);
  EXPECT_NEAR(book(plate.system), before, 1e-9);
  plate.system.bodies().set_kind(plate.body, BodyKind::static_);
  EXPECT_EQ(plate.system.energy().kinetic, 0);
  EXPECT_NEAR(book(plate.system), before, 1e-9);
  plate.system.bodies().set_kind(plate.body, BodyKind::scripted);
  plate.system.particles().set_position(plate.points[0], {0, 0.5, 0});
  (void)plate.system.step(1e-2);
  EXPECT_NEAR(book(plate.system), before, 1e-9) << "what the script carries is external work";
}

TEST(Rod, with_too_little_mass_at_an_end_has_no_motion_of_negative_energy) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId rod = system.bodies().create();
  const ParticleId p = system.particles().create(rod, {0, 0, 0}), q = system.particles().create(rod, {1, 0, 0});
  system.bodies().set_rod(rod, 6, 0.01);
  system.particles().set_mass(p, 0.01);
  system.particles().set_velocity(p, {0, -1, 0}), system.particles().set_velocity(q, {0, 0.01, 0});
  EXPECT_GT(system.energy().kinetic, 0);
  const double before = book(system);
  for (int i = 0; i < 100; ++i) (void)system.step(1.0 / 60);
  EXPECT_GT(system.energy().kinetic, 0);
  EXPECT_NEAR(book(system), before, 1e-9);
}

TEST(Rod, whose_end_is_shared_with_a_twin_that_leaves_stays_whole) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId rod = system.bodies().create();
  const ParticleId p = system.particles().create(rod, {0, 0, 0}), q = system.particles().create(rod, {1, 0, 0});
  system.bodies().set_rod(rod, 6, 0.01);
  system.particles().set_velocity(p, {0, -1, 0}), system.particles().set_velocity(q, {0, 2, 1});
  (void)system.step(1e-2);
  const double before = book(system);
  const ParticleId twin = system.edits().separate(p, p).created_particles.front();
  (void)system.edits().separate(p, twin);  // a body of its own, hinged to p
  (void)system.edits().separate(p, twin);  // and free
  for (int i = 0; i < 100; ++i) {
    (void)system.step(1.0 / 60);
    ASSERT_GT(system.energy().kinetic, 0);
  }
  EXPECT_NEAR(book(system), before, 1e-9);
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}

TEST(Combine, with_a_static_body_brings_the_other_one_to_it) {
  System system;
  const BodyId wall = system.bodies().create({.kind = BodyKind::static_}), link = system.bodies().create();
  const ParticleId hook = system.particles().create(wall, {0, 1, 0}, 0.001);
  system.particles().create(wall, {2, 1, 0}, 0.001);
  const ParticleId eye = system.particles().create(link, {0.3, 0.8, 0}, 100);
  system.particles().create(link, {0.3, 0.2, 0}, 100);
  (void)system.edits().combine(eye, hook);
  EXPECT_LT(norm(system.particles().position(eye) - Vec3{0, 1, 0}), 1e-9);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(system.step(1.0 / 60).unconverged, 0);
  EXPECT_LT(system.worst_gap(), 1e-9);
}

TEST(StaticBody, does_not_creep_under_a_load) {
  System system{SystemOptions{.mode = IntegrationMode::robust}};
  const auto chain =
      scenes::make_chain(system, {.links = 100, .nailed = false, .heavy_end = 1e6, .direction = {0, -1, 0}});
  const ParticleId hook =
      system.particles().create(system.bodies().create({.kind = BodyKind::static_}), {0, 0, 0}, 1e-3);
  (void)system.edits().combine(hook, chain.upper[0]);
  for (int i = 0; i < 600; ++i) (void)system.step(1.0 / 60);
  EXPECT_LT(norm(system.particles().position(hook)),
            3e-8);  // as far as the nails' relative compliance of 1e-12 gives under 1e6 N
}

TEST(Combine, of_particles_that_do_not_give_way_is_refused_and_changes_nothing) {
  System system;
  const BodyId wall = system.bodies().create({.kind = BodyKind::static_}), link = system.bodies().create();
  const ParticleId hook = system.particles().create(wall, {0, 1, 0}),
                   eye = system.particles().create(link, {0.3, 0.8, 0});
  system.particles().nail(eye);
  const auto hash = system.state_hash();
  EXPECT_THROW((void)system.edits().combine(hook, eye), std::invalid_argument);
  EXPECT_THROW((void)system.edits().combine(eye, hook, 0.5), std::invalid_argument);
  EXPECT_THROW(system.particles().nail(hook, {0, 2, 0}), std::invalid_argument);
  EXPECT_EQ(system.state_hash(), hash);
  system.particles().release(eye);
  EXPECT_NO_THROW((void)system.edits().combine(hook, eye));
}

TEST(Conflict, between_two_nails_on_one_link_is_no_solution) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 1, .link_length = 0.3});
  system.particles().nail(chain.lower[0]);
  EXPECT_EQ(system.step(1.0 / 60).unconverged, 0);
  system.particles().nail(chain.lower[0], {0.5, 0, 0});
  const StepReport report = system.step(1.0 / 60);
  EXPECT_NEAR(report.worst_gap, 0.2, 1e-9);
  EXPECT_EQ(report.unconverged, 1);
}

TEST(Rod, ends_when_its_two_ends_are_hinged_together_and_a_rope_hangs_on) {
  for (const auto kind : {ConstraintKind::rod, ConstraintKind::rope})
    for (const double over : {0.0, 0.1}) {
      System system;
      const auto a = scenes::make_chain(system, {.links = 2, .top = {0, 0, 0}});
      const auto b = scenes::make_chain(system, {.links = 2, .top = {0, -0.3, 0}, .direction = {0.8, 0.6, 0}});
      (void)system.joints().create(DistanceSpec{.kind = kind, .p = a.lower[1], .q = b.lower[1]});
      (void)system.step(1.0 / 60);
      (void)system.edits().combine(a.lower[1], b.lower[1], over);
      for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 60);
      EXPECT_EQ(system.joints().ids().size(), kind == ConstraintKind::rope ? 1u : 0u);
      EXPECT_EQ(system.validate(), std::vector<std::string>{});
      const StepReport report = system.step(1.0 / 60);
      EXPECT_LT(report.worst_gap, 1e-6);
    }
}

TEST(Rod, ends_when_others_hinge_its_two_ends_together) {
  // The rod's ends are of the second links; who is combined are the first ones, which hang at the same points.
  System system;
  const auto a = scenes::make_chain(system, {.links = 2, .top = {0, 0, 0}});
  const auto b = scenes::make_chain(system, {.links = 2, .top = {0, -0.1, 0}, .direction = {0.8, 0.6, 0}});
  (void)system.joints().create(DistanceSpec{.kind = ConstraintKind::rod, .p = a.upper[1], .q = b.upper[1]});
  const RestructureReport report = system.edits().combine(a.lower[0], b.lower[0]);
  EXPECT_TRUE(system.joints().ids().empty());
  EXPECT_EQ(report.notes.size(), 1u);
  EXPECT_LT(system.step(1.0 / 60).worst_gap, 1e-6);
}

TEST(Gap, between_two_nails_is_reported_and_not_booked_on_bodies_that_cannot_move) {
  System system;
  const BodyId still = system.bodies().create(), other = system.bodies().create();
  const ParticleId p = system.particles().create(still, {0, 0, 0}), q = system.particles().create(other, {1, 0, 0});
  const ConstraintId rod = system.joints().create(DistanceSpec{.kind = ConstraintKind::rod, .p = p, .q = q});
  system.particles().nail(p), system.particles().nail(q);
  EXPECT_EQ(system.step(0.01).unconverged, 0);
  system.particles().nail(q, {1.5, 0, 0});
  EXPECT_EQ(system.step(0.01).unconverged, 1);
  EXPECT_GT(system.worst_gap(), 0.4);
  EXPECT_GT(system.joints().state(rod).gap, 0.4);
  for (const BodyKind kind : {BodyKind::inactive, BodyKind::scripted}) {
    system.bodies().set_kind(other, kind);
    if (kind == BodyKind::scripted) system.bodies().set_kind(still, BodyKind::static_);
    const StepReport report = system.step(0.01);
    EXPECT_EQ(report.unconverged, 0);
    EXPECT_LT(report.worst_gap, 1e-12);
    EXPECT_EQ(system.joints().state(rod).gap, 0);
    EXPECT_EQ(system.joints().state(rod).force, Vec3{});
  }
}

TEST(Law, that_is_infinite_where_its_ends_meet_leaves_the_energy_book_finite) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 3});
  const ParticleId lone = system.particles().create(system.bodies().create(), {0.4, 0.2, 0});
  system.bonds().create(chain.lower[2], lone, SharedLaw{.law = system.laws().find("gravity")});
  (void)system.edits().combine(chain.lower[2], lone);
  EXPECT_TRUE(std::isfinite(book(system)));
  (void)system.step(1.0 / 60);
  EXPECT_TRUE(std::isfinite(book(system)));
}

TEST(Path, with_sharp_bends_makes_up_no_energy) {
  for (const double speed : {5.0, 20.0, 60.0}) {
    System system{SystemOptions{.gravity = {}}};
    const ParticleId bead = system.particles().create(system.bodies().create(), {0, 0, 0}, 1, {speed, 0, 0});
    PathSpec path{.particle = bead, .curve = CurveKind::polyline, .closed = true, .rounding = 0.05};
    path.points = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.3, 0}, {0.5, 0.8, 0}, {-1, 0.5, 0}};
    (void)system.joints().create(path);
    (void)system.step(1.0 / 240);
    const double start = system.energy().total();
    double highest = 0;
    for (int i = 0; i < 240; ++i) highest = std::max(highest, system.step(1.0 / 240).energy.total());
    EXPECT_LT(highest, 1.1 * start) << speed << " m/s";
  }
}

TEST(Grip, holds_the_remaining_particles_when_one_of_them_is_destroyed) {
  Plate plate;
  const GripId grip = plate.system.grips().create(plate.body, {0.1, 0, 0}, {1, 1, 1});
  plate.system.particles().destroy(plate.points[3]);
  EXPECT_TRUE(plate.system.grips().contains(grip));
  EXPECT_EQ(plate.system.validate(), std::vector<std::string>{});
  for (int i = 0; i < 30; ++i) (void)plate.system.step(1.0 / 60);
  EXPECT_EQ(plate.system.validate(), std::vector<std::string>{});
}

// --- what combining makes of kinds, damping and many bodies at once ------------------------------------------------------

TEST(CombineBodies, means_the_same_in_either_order_for_all_pairs_of_kinds) {
  struct Made {
    System system{SystemOptions{.gravity = {0, -9.81, 0}, .threads = 1}};
    BodyId moving_along;
    RestructureReport report;
    BodyId whole;
    ParticleId far_a, far_b, hinged;

    Made(BodyKind kind_a, BodyKind kind_b, double mass_a, double mass_b, bool swapped) {
      const auto body = [&](double x, double mass, double damping) {
        const BodyId made = system.bodies().create({.damping = damping});
        for (const Vec3& at : {Vec3{x, 0, 0}, Vec3{x + 1, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}})
          system.particles().create(made, at, mass, {0.3 * x, 0.2, -0.1});
        return made;
      };
      const BodyId a = body(0, mass_a, 0.1), b = body(2, mass_b, 0.4), c = body(3, 1, 0);
      far_a = system.bodies().particles(a)[2], far_b = system.bodies().particles(b)[3];
      hinged = system.bodies().particles(c)[1];
      (void)system.edits().combine(system.bodies().particles(b)[1], system.bodies().particles(c)[0]);
      system.bodies().set_kind(a, kind_a), system.bodies().set_kind(b, kind_b);
      report = swapped ? system.edits().combine(b, a) : system.edits().combine(a, b);
      whole = swapped ? b : a;
    }
  };
  const std::array kinds{BodyKind::dynamic, BodyKind::static_, BodyKind::scripted, BodyKind::inactive,
                         BodyKind::resting};
  std::mt19937 random(3);
  for (const BodyKind kind_a : kinds)
    for (const BodyKind kind_b : kinds) {
      const double mass_a = std::exp(static_cast<double>(random() % 9)), mass_b = 1.5;
      Made one(kind_a, kind_b, mass_a, mass_b, false), other(kind_a, kind_b, mass_a, mass_b, true);
      const auto pair = [&] {
        return std::to_string(static_cast<int>(kind_a)) + " with " + std::to_string(static_cast<int>(kind_b));
      };
      EXPECT_EQ(one.system.bodies().kind(one.whole), other.system.bodies().kind(other.whole)) << pair();
      EXPECT_NEAR(one.system.bodies().damping(one.whole), other.system.bodies().damping(other.whole), 1e-15) << pair();
      EXPECT_EQ(one.report.notes.size(), other.report.notes.size()) << pair();
      const bool is_held = kind_a == BodyKind::static_ || kind_b == BodyKind::static_ || kind_a == BodyKind::scripted ||
                           kind_b == BodyKind::scripted;
      const bool is_free = (kind_a == BodyKind::dynamic || kind_a == BodyKind::resting) &&
                           (kind_b == BodyKind::dynamic || kind_b == BodyKind::resting);
      EXPECT_EQ(one.report.notes.empty(), is_free || kind_a == kind_b) << pair() << ": a change of kind is told";
      EXPECT_LT(norm(one.report.momentum_change - other.report.momentum_change), 1e-9 * (1 + mass_a)) << pair();
      const Vec3 before = one.system.particles().position(one.far_a);
      for (int i = 0; i < 30; ++i) (void)one.system.step(1.0 / 60), (void)other.system.step(1.0 / 60);
      for (const auto particle : {&Made::far_a, &Made::far_b, &Made::hinged})
        EXPECT_LT(
            norm(one.system.particles().position(one.*particle) - other.system.particles().position(other.*particle)),
            0.02)  // another basis solves with other errors of the step
            << pair();
      if (is_held) {
        EXPECT_LT(norm(one.system.particles().position(one.far_a) - before), 1e-9) << pair() << " stays";
      }
      EXPECT_EQ(one.system.validate(), std::vector<std::string>{}) << pair();
    }
}

/// A chain that turns and flies, of points off one line, so that the bodies made of it are solid.
struct FlyingChain {
  System system{SystemOptions{.gravity = {}, .threads = 1}};
  std::vector<BodyId> links;

  explicit FlyingChain(int count) {
    const auto joint = [](int i) { return Vec3{0.1 * i, 0.05 * (i % 2), 0.03 * (i % 3)}; };
    for (int i = 0; i < count; ++i) {
      links.push_back(system.bodies().create());
      const auto particle = [&](const Vec3& x, double mass) {
        return system.particles().create(links.back(), x, mass, {0.1 - 0.5 * x.y, 0.2 + 0.5 * x.x, -0.3 * x.x});
      };
      const ParticleId upper = particle(joint(i), 1 + 0.1 * (i % 4));
      particle(joint(i + 1), 0.7);
      if (i > 0)
        (void)system.edits().combine(system.bodies().particles(links[static_cast<std::size_t>(i) - 1])[1], upper);
    }
    (void)system.step(1e-3);
  }
};

TEST(Batch, of_many_rigid_joins_gives_the_motion_that_they_give_one_by_one) {
  constexpr int count = 90;  // beyond 64 points a body keeps its basis where it can
  FlyingChain batch(count), single(count);
  const Vec3 momentum = batch.system.momentum(), spin = batch.system.angular_momentum();
  batch.system.edits().begin();
  for (int i = 1; i < count; ++i)
    (void)batch.system.edits().combine(batch.links[0], batch.links[static_cast<std::size_t>(i)]);
  const RestructureReport report = batch.system.edits().end();
  double lost = 0;
  for (int i = 1; i < count; ++i)
    lost += single.system.edits().combine(single.links[0], single.links[static_cast<std::size_t>(i)]).energy_change;
  EXPECT_EQ(batch.system.validate(), std::vector<std::string>{});
  EXPECT_EQ(report.absorbed_bodies.size(), count - 1u);
  EXPECT_LT(lost, -1e-4) << "turning about each other takes energy with it";
  EXPECT_NEAR(report.energy_change, lost, 1e-6 * std::abs(lost));
  EXPECT_LT(norm(batch.system.momentum() - momentum), 1e-9 * norm(momentum));
  EXPECT_LT(norm(batch.system.angular_momentum() - spin), 1e-9 * norm(spin));
  const std::vector<ParticleId> points = batch.system.bodies().particles(batch.links[0]);
  ASSERT_EQ(points, single.system.bodies().particles(single.links[0]));
  std::vector<Vec3> at;
  for (const ParticleId p : points) {
    EXPECT_LT(norm(batch.system.particles().velocity(p) - single.system.particles().velocity(p)), 1e-8);
    at.push_back(batch.system.particles().position(p));
  }
  for (int i = 0; i < 100; ++i) (void)batch.system.step(1e-2);
  for (std::size_t i = 7; i < points.size(); i += 7) {
    const double now =
        norm(batch.system.particles().position(points[i]) - batch.system.particles().position(points[3]));
    EXPECT_NEAR(now, norm(at[i] - at[3]), 1e-9) << "it is rigid";
  }
  EXPECT_TRUE(batch.system.edits().undo());
  EXPECT_EQ(batch.system.bodies().ids().size(), std::size_t{count});
}

TEST(SeparatePart, of_a_large_body_part_by_part_gives_the_chain_back) {
  constexpr std::size_t count = 90;
  FlyingChain chain(count);
  System& system = chain.system;
  system.edits().begin();
  for (std::size_t i = 1; i < count; ++i) (void)system.edits().combine(chain.links[0], chain.links[i]);
  (void)system.edits().end();
  (void)system.step(1e-3);
  const Vec3 momentum = system.momentum(), spin = system.angular_momentum();
  const double energy = system.energy().kinetic;
  std::vector<BodyId> parts(chain.links.begin() + 1, chain.links.end());
  std::shuffle(parts.begin(), parts.end(), std::mt19937(5));
  for (const BodyId part : parts) {
    const RestructureReport report = system.edits().separate(chain.links[0], part);
    ASSERT_EQ(report.created_bodies.size(), 1u);
    ASSERT_EQ(system.validate(), std::vector<std::string>{});
  }
  EXPECT_EQ(system.bodies().ids().size(), count);
  EXPECT_EQ(system.bodies().articulate_count(), 1u) << "its hinges are back";
  EXPECT_LT(norm(system.momentum() - momentum), 1e-9 * norm(momentum));
  EXPECT_LT(norm(system.angular_momentum() - spin), 1e-9 * norm(spin));
  EXPECT_NEAR(system.energy().kinetic, energy, 1e-9 * energy);
  EXPECT_LT(system.step(1e-3).worst_gap, 1e-9);
}

TEST(Nail, of_a_particle_at_rest_where_it_is_moves_nothing) {
  System system({.mode = IntegrationMode::robust, .threads = 1});
  const scenes::Chain chain = scenes::make_chain(system, {.links = 5, .nailed = false});
  for (const ParticleId p : chain.upper) system.particles().set_velocity(p, {0, 0, 0});
  system.particles().nail(chain.upper[2]);
  EXPECT_EQ(system.energy().kinetic, 0);
  for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);
  EXPECT_LT(norm(system.particles().position(chain.upper[2]) - Vec3{0.2, 0, 0}), 1e-9);
  EXPECT_LT(system.particles().position(chain.upper[0]).y, -0.1) << "the rest swings about it";
}

}  // namespace
}  // namespace iota
