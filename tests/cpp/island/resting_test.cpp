// SPDX-License-Identifier: Apache-2.0
// Bodies that rest and wake; bodies, particles and articulates that are switched off and on.
#include "energy_book.h"
#include "scenes/chain.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <random>

#include <cmath>

namespace iota {
namespace {

/// A damped chain that hangs still soon.
struct Sleeper {
  System system{{.damping = 4, .rest = {.after = 0.5, .speed = 0.01}}};
  scenes::Chain chain = scenes::make_chain(system, {.links = 4, .direction = {0.6, -0.8, 0}});
  void wait() {
    for (int i = 0; i < 2000 && system.bodies().kind(chain.links[0]) != BodyKind::resting; ++i) (void)system.step(0.01);
    ASSERT_EQ(system.bodies().kind(chain.links[0]), BodyKind::resting);
  }
  /// Whether the next steps move it.
  bool wakes() {
    (void)system.step(0.01);
    return system.bodies().kind(chain.links[3]) == BodyKind::dynamic;
  }
};

TEST(Resting, an_island_that_is_slow_for_a_while_falls_asleep_as_a_whole) {
  Sleeper s;
  const double start = book(s.system);
  s.wait();
  StepReport report = s.system.step(0.01);
  EXPECT_EQ(report.resting, 4u);
  EXPECT_EQ(report.energy.kinetic, 0);
  const Vec3 end = s.system.particles().position(s.chain.lower[3]);
  for (int i = 0; i < 100; ++i) report = s.system.step(0.01);
  EXPECT_EQ(s.system.particles().position(s.chain.lower[3]), end);
  EXPECT_EQ(report.iterations_max, 0);  // nothing was solved
  EXPECT_NEAR(book(s.system), start, 1e-9);
}

TEST(Resting, sleep_is_for_those_who_ask_for_it) {
  System system({.damping = 4});
  const auto chain = scenes::make_chain(system, {.links = 2, .direction = {0, -1, 0}});
  for (int i = 0; i < 300; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.bodies().kind(chain.links[0]), BodyKind::dynamic);
}

TEST(Resting, a_pendulum_does_not_fall_asleep_where_it_turns_back) {
  System system({.rest = {.after = 0.1, .speed = 0.05}});
  const auto chain = scenes::make_chain(system, {.links = 1, .link_length = 1});
  for (int i = 0; i < 1000; ++i) {
    (void)system.step(0.01);
    ASSERT_EQ(system.bodies().kind(chain.links[0]), BodyKind::dynamic);
  }
}

TEST(Resting, whatever_touches_it_wakes_it) {
  const auto wakes = [](auto touch) {
    Sleeper s;
    s.wait();
    EXPECT_FALSE(s.wakes());
    touch(s);
    return s.wakes();
  };
  EXPECT_TRUE(wakes([](Sleeper& s) { s.system.particles().apply_force(s.chain.lower[2], {0.1, 0, 0}); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { s.system.particles().set_velocity(s.chain.lower[2], {0.1, 0, 0}); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { s.system.particles().nail(s.chain.upper[0], {0.1, 0, 0}); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { s.system.set_gravity({1, -9, 0}); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { (void)s.system.grips().create(s.chain.links[1], {}, {1, 1, 1}); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { (void)s.system.edits().separate(s.chain.lower[0], s.chain.upper[1]); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { s.system.particles().set_mass(s.chain.lower[3], 5); }));
  EXPECT_TRUE(wakes([](Sleeper& s) { s.system.bodies().set_kind(s.chain.links[0], BodyKind::dynamic); }));
  EXPECT_TRUE(wakes([](Sleeper& s) {
    const BodyId ball = s.system.bodies().create(Sphere{0.1}, {.position = {2, 0, 0}, .attachments = {{0, 0, 0}}});
    (void)s.system.bonds().create(s.system.bodies().attachments(ball)[0], s.chain.lower[1], SpringLaw{});
  }));
}

TEST(Resting, bodies_are_put_to_rest_by_hand_with_all_that_hangs_on_them) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 3});
  (void)system.step(0.01);
  const double start = book(system);
  system.bodies().set_kind(chain.links[1], BodyKind::resting);
  (void)system.step(0.01);
  for (const BodyId link : chain.links) EXPECT_EQ(system.bodies().kind(link), BodyKind::resting);
  EXPECT_NEAR(book(system), start, 1e-12);
  system.bodies().set_kind(chain.links[2], BodyKind::dynamic);
  (void)system.step(0.01);
  for (const BodyId link : chain.links) EXPECT_EQ(system.bodies().kind(link), BodyKind::dynamic);
  EXPECT_LT(system.particles().velocity(chain.lower[2]).y, -0.05);
  const BodyId fixed = system.bodies().create({.kind = BodyKind::static_});
  EXPECT_THROW(system.bodies().set_kind(fixed, BodyKind::resting), std::invalid_argument);
}

TEST(Resting, a_sleeper_stays_asleep_through_snapshot_and_replay) {
  Sleeper s;
  s.wait();
  s.system.record().start();
  for (int i = 0; i < 10; ++i) (void)s.system.step(0.01);
  s.system.particles().apply_force(s.chain.lower[2], {0.1, 0, 0});
  for (int i = 0; i < 200; ++i) (void)s.system.step(0.01);
  EXPECT_EQ(s.system.record().replay(s.system.record().stop()), std::nullopt);
  EXPECT_EQ(s.system.bodies().kind(s.chain.links[0]), BodyKind::resting);
}

TEST(Forces, on_immovable_bodies_end_with_the_step) {
  for (const BodyKind kind : {BodyKind::static_, BodyKind::scripted, BodyKind::inactive}) {
    System system{{.gravity = {}}};
    const BodyId body = system.bodies().create();
    const ParticleId p = system.particles().create(body, {0, 0, 0}), q = system.particles().create(body, {1, 0, 0});
    const ParticleId far = system.particles().create(system.bodies().create(), {2, 0, 0});
    const BondId pull = system.bonds().create(p, far, ScriptedLaw{[](const BondState&) { return Vec3{1, 0, 0}; }, ""});
    system.bodies().set_kind(body, kind);
    for (int i = 0; i < 10; ++i) {
      system.particles().apply_force(q, {0, 100, 0});
      (void)system.step(0.01);
    }
    system.bonds().destroy(pull);
    system.bodies().set_kind(body, BodyKind::dynamic);
    (void)system.step(0.01);
    EXPECT_EQ(norm(system.bodies().velocity(body)), 0) << static_cast<int>(kind);
    system.bodies().set_kind(body, kind);
    system.particles().apply_force(q, {0, 100, 0});
    system.bodies().set_kind(body, BodyKind::dynamic);
    (void)system.step(0.01);
    EXPECT_NEAR(system.bodies().velocity(body).y, 0.5, 1e-12) << "but it is in time for the step to come";
  }
}

TEST(Resting, what_sleeps_in_a_conflict_says_so_when_it_wakes) {
  // A link a tenth too short for the two places of a static body to which it is hinged: no step can do anything about it.
  System system;
  const BodyId wall = system.bodies().create(), link = system.bodies().create();
  const ParticleId left = system.particles().create(wall, {0, 0, 0}, 1),
                   right = system.particles().create(wall, {1, 0, 0}, 1);
  const ParticleId a = system.particles().create(link, {0, 0, 0}, 1),
                   b = system.particles().create(link, {0.9, 0, 0}, 1);
  (void)system.edits().combine(left, a);
  (void)system.edits().combine(right, b);
  system.bodies().set_kind(wall, BodyKind::static_);
  system.bodies().set_kind(link, BodyKind::resting);
  system.particles().set_mass(right, 2);
  const StepReport report = system.step(0.01);
  ASSERT_EQ(system.bodies().kind(link), BodyKind::dynamic);
  EXPECT_GT(report.worst_gap, 1e-3);
  EXPECT_EQ(report.unconverged, 1);
}

TEST(Active, an_inactive_body_is_out_of_the_world_until_it_is_back) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 4});
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  const double start = book(system);
  const Vec3 left = system.particles().position(chain.lower[3]);
  system.bodies().set_active(chain.links[3], false);
  EXPECT_FALSE(system.bodies().is_active(chain.links[3]));
  for (int i = 0; i < 50; ++i) {
    const StepReport report = system.step(0.01);
    EXPECT_EQ(report.unconverged, 0);
    EXPECT_LT(report.worst_gap, 1e-8);
  }
  EXPECT_EQ(system.particles().position(chain.lower[3]), left);
  EXPECT_NEAR(book(system), start, 1e-6);
  system.bodies().set_active(chain.links[3], true);
  EXPECT_EQ(system.bodies().kind(chain.links[3]), BodyKind::dynamic);
  EXPECT_LT(system.worst_gap(), 1e-8);  // its hinge is closed again
  for (int i = 0; i < 50; ++i) EXPECT_EQ(system.step(0.01).unconverged, 0);
  EXPECT_NEAR(book(system), start, 1e-6);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Active, a_body_comes_back_as_what_it_was) {
  System system;
  const BodyId fixed = system.bodies().create({.kind = BodyKind::static_});
  (void)system.particles().create(fixed, {});
  system.bodies().set_active(fixed, false);
  system.bodies().set_active(fixed, true);
  EXPECT_EQ(system.bodies().kind(fixed), BodyKind::static_);
}

TEST(Active, an_articulate_goes_and_comes_as_one) {
  System system;
  const auto a = scenes::make_chain(system, {.links = 3}),
             b = scenes::make_chain(system, {.links = 3, .top = {0, 0, 1}});
  system.bodies().set_articulate_active(a.links[1], false);
  for (int i = 0; i < 10; ++i) (void)system.step(0.01);
  for (const BodyId link : a.links) EXPECT_FALSE(system.bodies().is_active(link));
  EXPECT_EQ(system.particles().position(a.lower[2]).y, 0);
  EXPECT_LT(system.particles().position(b.lower[2]).y, -0.01);
  EXPECT_EQ(system.viewer().poses().bodies.size(), 3u);
  system.bodies().set_articulate_active(a.links[0], true);
  (void)system.step(0.01);
  EXPECT_LT(system.particles().position(a.lower[2]).y, 0);
}

TEST(Active, bonds_of_what_is_inactive_do_not_act) {
  System system({.gravity = {}});
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  const ParticleId p = system.particles().create(a, {0, 0, 0}), q = system.particles().create(b, {1, 0, 0});
  (void)system.bonds().create(p, q, SpringLaw{.stiffness = 10, .length = 0.5});
  const double energy = 0.5 * 10 * 0.25;
  EXPECT_NEAR(system.energy().potential, energy, 1e-15);
  for (const bool whole_body : {false, true}) {
    whole_body ? system.bodies().set_active(b, false) : system.particles().set_active(q, false);
    EXPECT_EQ(system.energy().potential, 0);
    (void)system.step(0.01);
    EXPECT_EQ(system.particles().velocity(p), Vec3{});
    whole_body ? system.bodies().set_active(b, true) : system.particles().set_active(q, true);
    EXPECT_NEAR(system.energy().potential, energy, 1e-15);
  }
  (void)system.step(0.01);
  EXPECT_GT(system.particles().velocity(p).x, 0.01);
}

TEST(Active, an_inactive_particle_weighs_next_to_nothing) {
  System system;
  const BodyId rod = system.bodies().create();
  const ParticleId hinge = system.particles().create(rod, {0, 0, 0}, 1),
                   middle = system.particles().create(rod, {0.5, 0, 0}, 2),
                   end = system.particles().create(rod, {1, 0, 0}, 3);
  system.particles().nail(hinge);
  system.particles().set_active(end, false);
  EXPECT_EQ(system.particles().mass(end), 3);
  EXPECT_NEAR(system.bodies().mass(rod), 3, 1e-5);
  const double start = book(system);
  // A pendulum of length 0.5 from the horizontal: at the bottom v^2 = 2 g l.
  double fastest = 0;
  for (int i = 0; i < 200; ++i) {
    (void)system.step(0.005);
    fastest = std::max(fastest, norm(system.particles().velocity(middle)));
  }
  EXPECT_NEAR(fastest, std::sqrt(2 * 9.81 * 0.5), 1e-3);
  EXPECT_NEAR(norm(system.particles().position(end) - system.particles().position(hinge)), 1, 1e-9);
  system.particles().set_active(end, true);
  EXPECT_EQ(system.bodies().mass(rod), 6);
  for (int i = 0; i < 20; ++i) (void)system.step(0.005);
  EXPECT_NEAR(book(system), start, 1e-6);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Scripted, what_the_script_has_moved_is_free_once_it_is_dynamic_and_its_nails_stay) {
  for (const bool nailed : {false, true})
    for (const bool by_way_of_static : {false, true}) {
      System system;
      const BodyId rod = system.bodies().create();
      const ParticleId first = system.particles().create(rod, {0, 2, 0}),
                       last = system.particles().create(rod, {1, 2, 0});
      if (nailed) system.particles().nail(first);
      system.bodies().set_kind(rod, BodyKind::scripted);
      for (int i = 1; i <= 30; ++i) {
        system.bodies().set_pose(rod, {0.5, 2 + 0.02 * i, 0}, {});
        (void)system.step(0.01);
      }
      EXPECT_NEAR(system.particles().position(last).y, 2.6, 1e-9);
      EXPECT_EQ(system.particles().is_nailed(first), nailed);
      EXPECT_FALSE(system.particles().is_nailed(last));
      if (by_way_of_static) system.bodies().set_kind(rod, BodyKind::static_);
      system.bodies().set_kind(rod, BodyKind::dynamic);
      system.particles().set_velocity(first, {});
      system.particles().set_velocity(last, {});
      for (int i = 0; i < 20; ++i) (void)system.step(0.01);
      const double fallen = 2.6 - system.particles().position(last).y;
      // Freely, or as a rod with a weight at its end about the other one: both begin with g.
      EXPECT_NEAR(fallen, 9.81 * 0.2 * 0.2 / 2, 0.01) << nailed << by_way_of_static;
      EXPECT_NEAR(system.particles().position(first).y, nailed ? 2.6 : 2.6 - fallen, 1e-9);
      EXPECT_TRUE(system.validate().empty());
    }
}

/// Many chains that sleep, with a ball that flies past them.
struct Crowd {
  System system{{.damping = 4, .rest = {.after = 0.5, .speed = 0.01}}};
  std::vector<scenes::Chain> chains;
  ParticleId ball;

  Crowd() {
    for (int i = 0; i < 12; ++i)
      chains.push_back(
          scenes::make_chain(system, {.links = 3, .top = {1.0 * i, 0.1 * i, 0}, .direction = {0.6, -0.8, 0}}));
    for (int i = 0; i < 4000 && system.step(0.01).resting < 36; ++i) {
    }
    ball = system.particles().create(system.bodies().create(), {0, 5, 1}, 2, {1, 0, 0});
  }
  void expect_the_same_book(const StepReport& report) const {
    const Energy now = system.energy();  // measured table by table
    EXPECT_NEAR(report.energy.kinetic, now.kinetic, 1e-12 * (1 + now.kinetic));
    EXPECT_NEAR(report.energy.potential, now.potential, 1e-12 * std::abs(now.potential));
    EXPECT_EQ(report.worst_gap, system.worst_gap());
    EXPECT_NEAR(report.energy.balance(), now.balance(), 1e-9);
  }
};

TEST(Still, bodies_have_the_energies_and_gaps_that_all_have_when_measured) {
  Crowd c;
  for (int i = 0; i < 20; ++i) {
    const StepReport report = c.system.step(0.01);
    EXPECT_EQ(report.resting, 36u);
    c.expect_the_same_book(report);
  }
  c.system.particles().apply_force(c.chains[4].lower[1], {3, 0, 0});
  for (int i = 0; i < 20; ++i) {
    const StepReport report = c.system.step(0.01);
    EXPECT_EQ(report.resting, 33u);
    c.expect_the_same_book(report);
  }
  c.system.particles().set_mass(c.chains[7].lower[2], 5);  // an edit of a sleeper
  c.expect_the_same_book(c.system.step(0.01));
  c.system.set_gravity({0, -5, 0});
  const StepReport woken = c.system.step(0.01);
  EXPECT_EQ(woken.resting, 0u);
  c.expect_the_same_book(woken);
}

TEST(Still, bodies_are_counted_and_booked_whatever_freezes_wakes_and_ties_them) {
  Crowd c;
  Bodies bodies = c.system.bodies();
  std::mt19937 random(3);
  const auto any_body = [&] { return bodies.ids().at(random() % bodies.ids().size()); };
  for (int i = 0; i < 600; ++i) {
    const Energy before = c.system.energy();
    try {
      switch (random() % 12) {
        case 8: c.system.set_gravity({0.1 * static_cast<double>(random() % 5), -9, 0}); break;
        case 9: c.system.particles().set_mass(bodies.particles(any_body())[0], 1.0 + 0.1 * (random() % 20)); break;
        case 10: c.system.particles().set_velocity(bodies.particles(any_body())[0], {0.3, 0, 1}); break;
        case 11: bodies.set_pose(any_body(), {1.0 * (random() % 12), 0.5, 0}, {}); break;
        case 0: bodies.set_stride(any_body(), 0); break;
        case 1: bodies.set_stride(any_body(), 1); break;
        case 2: bodies.set_stride(any_body(), 4); break;
        case 3: bodies.set_kind(any_body(), BodyKind::resting); break;
        case 4: bodies.set_kind(any_body(), BodyKind::dynamic); break;
        case 5: c.system.particles().apply_force(bodies.particles(any_body())[0], {0, 3, 1}); break;
        case 6: bodies.set_kind(any_body(), BodyKind::inactive); break;
        default: break;
      }
    } catch (const std::invalid_argument&) {  // a part of a chain alone can't rest, for example
    }
    const Energy edited = c.system.energy();  // measured table by table
    EXPECT_NEAR(edited.edits - before.edits, edited.total() - before.total(), 1e-9) << "step " << i;
    const StepReport report = c.system.step(0.01);
    std::uint32_t resting = 0;
    for (const BodyId body : bodies.ids()) resting += bodies.kind(body) == BodyKind::resting;
    ASSERT_EQ(report.resting, resting) << "step " << i;
    const Energy now = c.system.energy();
    ASSERT_NEAR(report.energy.kinetic + report.energy.potential, now.kinetic + now.potential, 1e-9) << "step " << i;
    ASSERT_NEAR(report.energy.balance(), edited.balance(), 1e-9) << "step " << i;
    ASSERT_EQ(report.worst_gap, c.system.worst_gap());
  }
}

TEST(Still, bodies_are_the_same_bits_after_a_snapshot) {
  Crowd c;
  System other;
  other.restore(c.system.snapshot());
  for (int i = 0; i < 50; ++i) {
    if (i == 20) {
      c.system.particles().apply_force(c.chains[4].lower[1], {3, 0, 0});
      other.particles().apply_force(c.chains[4].lower[1], {3, 0, 0});
    }
    const StepReport a = c.system.step(0.01), b = other.step(0.01);
    ASSERT_EQ(c.system.state_hash(), other.state_hash()) << "step " << i;
    EXPECT_EQ(a.resting, b.resting);
  }
}

TEST(Still, particles_are_moved_by_what_wakes_them) {
  System system({.gravity = {}, .rest = {.after = 0.1, .speed = 0.01}});
  std::vector<ParticleId> particles;
  for (int i = 0; i < 8; ++i) particles.push_back(system.particles().create(system.bodies().create(), {1.0 * i, 0, 0}));
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.step(0.01).resting, 8u);
  system.particles().apply_force(particles[2], {5, 0, 0});
  system.particles().set_velocity(particles[5], {0, 1, 0});
  system.bodies().set_kind(system.particles().body(particles[6]), BodyKind::dynamic);
  EXPECT_EQ(system.step(0.01).resting, 5u);
  EXPECT_GT(system.particles().position(particles[2]).x, 2);
  EXPECT_GT(system.particles().position(particles[5]).y, 0);
  for (int i = 0; i < 30; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.step(0.01).resting, 6u) << "the one that was only woken sleeps again";
}

TEST(Still, scripted_bodies_move_what_hangs_on_them_when_they_begin_to_move) {
  System system({.damping = 4, .rest = {.after = 0.5, .speed = 0.01}});
  const BodyId hand = system.bodies().create(Sphere{0.1}, {.attachments = {{0, 0, 0}}, .kind = BodyKind::scripted});
  const ParticleId grip = system.bodies().attachments(hand)[0];
  const BodyId rod = system.bodies().create();
  const ParticleId top = system.particles().create(rod, {0, 0, 0}), end = system.particles().create(rod, {0, -1, 0});
  (void)system.edits().combine(grip, top);
  for (int i = 0; i < 200; ++i) (void)system.step(0.01);
  ASSERT_EQ(system.bodies().kind(rod), BodyKind::resting);
  system.particles().set_position(grip, {0.2, 0, 0});
  for (int i = 0; i < 3; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.bodies().kind(rod), BodyKind::dynamic);
  EXPECT_NEAR(system.particles().position(top).x, 0.2, 1e-9);
  for (int i = 0; i < 2000 && system.bodies().kind(rod) != BodyKind::resting; ++i) (void)system.step(0.01);
  EXPECT_NEAR(system.particles().position(end).x, 0.2, 5e-3);
}

}  // namespace
}  // namespace iota
