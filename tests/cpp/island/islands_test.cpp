// SPDX-License-Identifier: Apache-2.0
// Which articulates are solved together.
#include "island/islands.h"

#include "ingredient/bonds.h"
#include "ingredient/closings.h"
#include "ingredient/constraint.h"
#include "ingredient/grips.h"
#include "scenes/chain.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace iota::island {
namespace {

using model::SmallModel;

struct Room {
  SmallModel m;
  Islands islands;
  Parallel parallel{1};

  void update() {
    (void)islands.update(m.model, parallel);
    model::Audit audit(m.model);
    islands.validate(m.model, audit);
    EXPECT_EQ(std::move(audit).complaints(), std::vector<std::string>{});
  }
  Island* of(std::uint32_t body) const { return islands.of_articulate(m.model.bodies[body].articulate); }
  bool are_together(std::uint32_t a, std::uint32_t b) const { return a == b || (of(a) && of(a) == of(b)); }
  std::uint32_t bond(std::uint32_t a, std::uint32_t b) {
    ingredient::Bond spring;
    spring.p = m.particle(a, 1), spring.q = m.particle(b, 0);
    return ingredient::Bonds::add(m.model, spring);
  }
  std::vector<std::uint32_t> rods(int count) {
    std::vector<std::uint32_t> bodies;
    for (int i = 0; i < count; ++i) bodies.push_back(m.body({{0, 2.0 * i, 0}, {1, 2.0 * i, 0}}));
    return bodies;
  }
};

TEST(Islands, have_a_chain_each_and_nothing_for_a_free_particle) {
  Room room;
  const auto first = room.m.chain(3), second = room.m.chain(4, {0, 5, 0});
  const std::uint32_t free = room.m.body({{9, 9, 9}});
  room.update();
  EXPECT_EQ(room.islands.all().size(), 2u);
  for (const std::uint32_t body : first) EXPECT_EQ(room.of(body), room.of(first[0]));
  EXPECT_NE(room.of(first[0]), room.of(second[0]));
  EXPECT_EQ(room.of(second[0])->body_count(), 4u);
  EXPECT_EQ(room.of(free), nullptr);
  EXPECT_EQ(room.islands.free_bodies().size(room.m.model), 1u);
}

TEST(Islands, become_one_by_a_bond_and_two_again_without_it) {
  Room room;
  const auto rods = room.rods(2);
  room.update();
  EXPECT_FALSE(room.are_together(rods[0], rods[1]));
  const std::uint32_t bond = room.bond(rods[0], rods[1]);
  room.update();
  EXPECT_TRUE(room.are_together(rods[0], rods[1]));
  ingredient::Bonds::remove(room.m.model, bond);
  room.update();
  EXPECT_FALSE(room.are_together(rods[0], rods[1]));
}

TEST(Islands, that_nothing_happened_to_are_kept) {
  Room room;
  const auto chain = room.m.chain(3, {0, 9, 0}), rods = room.rods(2);
  room.update();
  const Island* const untouched = room.of(chain[0]);
  (void)room.bond(rods[0], rods[1]);
  room.update();
  EXPECT_EQ(room.of(chain[0]), untouched);
  EXPECT_EQ(room.islands.all().size(), 2u);
}

/// The new body has the slots of the old one and of its articulate. It had moved with the points of the old one.
TEST(Islands, do_not_take_a_new_body_for_one_whose_slot_it_has) {
  for (const std::size_t which : {0u, 20u, 39u}) {
    System system;
    const scenes::Chain chain = scenes::make_chain(system, {.links = 40});
    for (int i = 0; i < 3; ++i) (void)system.step(0.01);
    system.bodies().destroy(chain.links[which]);
    const BodyId fresh = system.bodies().create();
    ASSERT_EQ(fresh.slot, chain.links[which].slot);
    const ParticleId left = system.particles().create(fresh, {9, 0, 0}, 1, {0, 1, 0}),
                     right = system.particles().create(fresh, {10, 0, 0}, 1, {0, -1, 0});
    for (int i = 0; i < 10; ++i) {
      (void)system.step(0.01);
      EXPECT_NEAR(norm(system.particles().position(left) - system.particles().position(right)), 1, 1e-9) << which;
    }
    EXPECT_EQ(system.islands().size(), which == 20 ? 3u : 2u);
    EXPECT_TRUE(system.validate().empty());
  }
}

TEST(Islands, put_articulates_down_to_the_leader_of_their_island) {
  Room room;
  const auto rods = room.rods(4);
  (void)room.bond(rods[3], rods[1]);
  room.update();
  std::vector<std::uint32_t> articulates;
  for (const std::uint32_t rod : {rods[3], rods[1], rods[0], rods[3]})
    articulates.push_back(room.m.model.bodies[rod].articulate);
  room.islands.replace_by_leaders(articulates);
  EXPECT_EQ(articulates,
            (std::vector{room.m.model.bodies[rods[0]].articulate, room.m.model.bodies[rods[1]].articulate}));
}

/// Whether the island of a chain of 200 rods follows a cut in its middle: then its two halves stay in one problem for a
/// while. `prepare(room, chain)` comes before the first step, so that only the cut is followed.
template <class Prepare>
bool follows_a_cut(Prepare prepare) {
  Room room;
  const auto chain = room.m.chain(200);
  prepare(room, chain);
  room.update();
  RestructureReport report;
  (void)model::separate_particles(room.m.model, room.m.particle(chain[99], 1), room.m.particle(chain[100], 0), report);
  EXPECT_NE(room.m.model.bodies[chain[0]].articulate, room.m.model.bodies[chain[199]].articulate);
  room.update();
  return room.of(chain[0]) == room.of(chain[199]);
}

void hold(Room& room, std::uint32_t body) {
  ingredient::Grip grip;
  grip.body = body, grip.frequency = 1, grip.max_acceleration = 1;
  ingredient::Grips::anchor(room.m.model, grip, room.m.model.center_of_mass(body));
  ingredient::Grips::mark(room.m.model, body);
  room.m.model.grips.create(grip);
}

TEST(Islands, follow_a_cut_in_place_also_in_chains_that_are_held_damped_or_closing) {
  using Chain = std::vector<std::uint32_t>;
  EXPECT_TRUE(follows_a_cut([](Room&, const Chain&) {}));
  EXPECT_TRUE(follows_a_cut([](Room& room, const Chain& chain) { hold(room, chain[99]); }));
  EXPECT_TRUE(follows_a_cut([](Room& room, const Chain& chain) { hold(room, chain[10]), hold(room, chain[150]); }));
  EXPECT_TRUE(follows_a_cut([](Room& room, const Chain& chain) {
    for (const std::uint32_t body : {chain[5], chain[100]}) room.m.model.set_damping(body, 0.5);
  }));
  EXPECT_TRUE(follows_a_cut([](Room& room, const Chain& chain) {
    ingredient::Closing closing;
    closing.p = room.m.particle(chain[30], 1), closing.q = room.m.particle(chain[60], 1);
    closing.distance = 30, closing.duration = 1;
    ingredient::Closings::add(room.m.model, closing);
  }));
}

TEST(Islands, are_not_for_loose_bodies_unless_something_holds_or_ties_them) {
  Room room;
  const auto rods = room.rods(4);
  const std::uint32_t plate = room.m.body({{0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
  const auto owners = [&] {
    room.update();
    std::vector<std::uint32_t> found;
    for (const std::uint32_t body : {rods[0], rods[1], rods[2], rods[3], plate})
      if (room.of(body)) found.push_back(body);
    return found;
  };
  using Bodies = std::vector<std::uint32_t>;
  EXPECT_EQ(owners(), Bodies{});
  EXPECT_EQ(room.islands.free_bodies().size(room.m.model), 5u);
  const std::uint32_t bond = room.bond(rods[0], rods[1]);
  hold(room, plate);
  room.m.model.bodies[rods[3]].kind = BodyKind::static_, room.m.model.mark_body(rods[3]);
  EXPECT_EQ(owners(), (Bodies{rods[0], rods[1], rods[3], plate}));
  ingredient::Bonds::remove(room.m.model, bond);
  room.m.model.grips.destroy(0), ingredient::Grips::mark(room.m.model, plate);
  room.m.model.bodies[rods[3]].kind = BodyKind::dynamic, room.m.model.mark_body(rods[3]);
  EXPECT_EQ(owners(), Bodies{});
  EXPECT_EQ(room.islands.all().size(), 0u);
}

// A chain of 200 rods is a large island, a rod is a small one.
TEST(Islands, take_smaller_ones_over_and_give_them_back) {
  Room room;
  const auto chain = room.m.chain(200), other = room.m.chain(60, {0, 9, 0});
  const auto rods = room.rods(3);
  room.update();
  Island* const large = room.of(chain[0]);
  const std::uint32_t bond = room.bond(chain[50], rods[0]);
  (void)room.bond(rods[0], rods[1]);
  room.update();
  EXPECT_EQ(room.of(chain[0]), large);
  EXPECT_EQ(room.of(rods[1]), large);
  EXPECT_EQ(large->body_count(), 202u);
  EXPECT_EQ(large->size(), 201u + 4u);
  const std::uint32_t bridge = room.bond(other[59], chain[199]);
  room.update();
  EXPECT_EQ(room.of(other[0]), large) << "also of another large one";
  EXPECT_EQ(large->body_count(), 262u);
  ingredient::Bonds::remove(room.m.model, bond);
  room.update();
  EXPECT_EQ(room.of(chain[0]), large);
  EXPECT_NE(room.of(rods[1]), large) << "a small part leaves at once";
  EXPECT_EQ(room.of(rods[1]), room.of(rods[0]));
  EXPECT_EQ(large->size(), 201u + 61u);
  ingredient::Bonds::remove(room.m.model, bridge);
  room.update();
  EXPECT_EQ(room.of(other[0]), large) << "a large one stays for a while";
}

TEST(Islands, let_large_parts_go_some_steps_after_the_cut_while_other_cuts_go_on) {
  Room room;
  const auto chain = room.m.chain(200), other = room.m.chain(60, {0, 9, 0});
  const auto rods = room.rods(1);
  const std::uint32_t bridge = room.bond(other[59], chain[199]);
  room.update();
  Island* const large = room.of(chain[0]);
  ingredient::Bonds::remove(room.m.model, bridge);
  for (int step = 0; step < 130; ++step) {
    const std::uint32_t bond = room.bond(chain[10], rods[0]);
    room.update();
    ingredient::Bonds::remove(room.m.model, bond);
    ++room.m.model.step;
    room.update();
  }
  EXPECT_EQ(room.of(chain[0]), large);
  EXPECT_NE(room.of(other[0]), large);
  EXPECT_EQ(room.islands.all().size(), 2u);
  EXPECT_EQ(room.of(rods[0]), nullptr);
}

// Against a search through all bonds, over random bonds that come and go.
TEST(Islands, are_the_connected_sets_of_bodies_whatever_comes_and_goes) {
  Room room;
  const auto rods = room.rods(20);
  std::mt19937 random(5);
  std::vector<std::uint32_t> bonds;
  for (int round = 0; round < 200; ++round) {
    if (bonds.size() < 15 && random() % 2) {
      const std::uint32_t a = rods[random() % rods.size()], b = rods[random() % rods.size()];
      if (a != b) bonds.push_back(room.bond(a, b));
    } else if (!bonds.empty()) {
      std::swap(bonds[random() % bonds.size()], bonds.back());
      ingredient::Bonds::remove(room.m.model, bonds.back());
      bonds.pop_back();
    }
    room.update();
    std::vector<std::uint32_t> group(rods.size());
    for (std::uint32_t i = 0; i < group.size(); ++i) group[i] = i;
    const auto index_of = [&](std::uint32_t particle) {
      return static_cast<std::size_t>(std::find(rods.begin(), rods.end(), room.m.model.particles[particle].body) -
                                      rods.begin());
    };
    for (std::size_t pass = 0; pass < rods.size(); ++pass)
      for (const std::uint32_t bond : bonds) {
        std::uint32_t &p = group[index_of(room.m.model.bonds[bond].p)],
                      &q = group[index_of(room.m.model.bonds[bond].q)];
        p = q = std::min(p, q);
      }
    ASSERT_EQ(room.islands.all().size() + room.islands.free_bodies().size(room.m.model),
              std::set<std::uint32_t>(group.begin(), group.end()).size())
        << round;
    for (std::size_t i = 0; i < rods.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_EQ(room.are_together(rods[i], rods[j]), group[i] == group[j]) << round << ' ' << i << ' ' << j;
  }
}

// The rod to it is no row, and acts again with the body.
TEST(Islands, keep_inactive_bodies_that_are_tied_to_them_after_a_cut_elsewhere) {
  constexpr int links = 200;
  System system;
  std::vector<ParticleId> ends;
  for (int i = 0; i < links; ++i) {
    const BodyId link = system.bodies().create();
    for (const int end : {0, 1}) ends.push_back(system.particles().create(link, {double(i + end), 0, 0}, 1));
    if (i > 0) (void)system.edits().combine(ends[ends.size() - 3], ends[ends.size() - 2]);
  }
  const BodyId loose = system.bodies().create();
  const ParticleId near = system.particles().create(loose, {links, 1, 0}, 1);
  (void)system.particles().create(loose, {links + 1, 1, 0}, 1);
  (void)system.joints().create(DistanceSpec{.kind = ConstraintKind::rod, .p = ends.back(), .q = near});
  system.bodies().set_kind(loose, BodyKind::inactive);
  (void)system.step(1.0 / 120);
  (void)system.edits().separate(ends[21], ends[22]);
  (void)system.step(1.0 / 120);
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
  system.bodies().set_kind(loose, BodyKind::dynamic);
  (void)system.step(1.0 / 120);
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
  EXPECT_NEAR(norm(system.particles().position(near) - system.particles().position(ends.back())), 1, 1e-9);
}

// Both between two steps: it had stayed among the unknowns, and crept.
TEST(Islands, let_go_of_a_body_that_is_cut_off_and_changes_its_kind_at_once) {
  constexpr int links = 60;
  for (const BodyKind kind : {BodyKind::static_, BodyKind::scripted, BodyKind::inactive}) {
    System system;
    std::vector<BodyId> bodies;
    std::vector<ParticleId> ends;
    for (int i = 0; i < links; ++i) {
      bodies.push_back(system.bodies().create());
      for (const int end : {0, 1}) ends.push_back(system.particles().create(bodies.back(), {double(i + end), 0, 0}, 1));
      if (i > 0) (void)system.edits().combine(ends[ends.size() - 3], ends[ends.size() - 2]);
    }
    system.particles().nail(ends.front());
    for (int i = 0; i < 5; ++i) (void)system.step(1.0 / 60);
    for (const int end : {79, 81}) (void)system.edits().separate(ends[end], ends[end + 1]);
    system.bodies().set_kind(bodies[40], kind);
    const Vec3 place = system.particles().position(ends[80]);
    for (int i = 0; i < 30; ++i) {
      (void)system.step(1.0 / 60);
      ASSERT_EQ(system.validate(), std::vector<std::string>{}) << static_cast<int>(kind) << ' ' << i;
    }
    EXPECT_EQ(system.particles().position(ends[80]), place) << static_cast<int>(kind);
  }
}

// Grips on bodies whose island is new in the same update. With threads it was built by two of them at once.
TEST(Islands, are_built_once_where_bodies_are_held_cut_and_joined_at_once) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    System system;
    ParticleId last{};
    for (int i = 0; i < 20; ++i) {
      const BodyId body = system.bodies().create();
      const Vec3 start{0.1 * i, 0.01 * i, 0};
      const ParticleId p = system.particles().create(body, start, 0.05);
      if (i > 0) (void)system.edits().combine(last, p);
      last = system.particles().create(body, start + Vec3{0.1, 0.01, 0}, 0.05);
    }
    std::vector<GripId> grips;
    const auto edit = [&] {
      const std::vector<ParticleId> points = system.particles().ids();
      const std::vector<BodyId> bodies = system.bodies().ids();
      const ParticleId p = points[random() % points.size()], q = points[random() % points.size()];
      const BodyId body = bodies[random() % bodies.size()];
      switch (random() % 6) {
        case 0:
        case 1: (void)system.edits().combine(p, q); break;
        case 2: (void)system.edits().separate(p, q); break;
        case 3: grips.push_back(system.grips().create(body, {}, {number(), number(), number()})); break;
        case 4: system.bodies().set_velocity(body, {number(), number(), number()}); break;
        default:
          if (grips.empty()) break;
          system.grips().destroy(grips.back());
          grips.pop_back();
      }
    };
    for (int step = 0; step < 100; ++step) {
      for (std::size_t edits = random() % 4; edits > 0; --edits) try {
          edit();
          ASSERT_EQ(system.validate(), std::vector<std::string>{}) << seed << ' ' << step;
        } catch (const std::invalid_argument&) {  // they are one already, or share nothing
        }
      (void)system.step(1.0 / 120);
      ASSERT_EQ(system.validate(), std::vector<std::string>{}) << seed << ' ' << step;
    }
  }
}

}  // namespace
}  // namespace iota::island
