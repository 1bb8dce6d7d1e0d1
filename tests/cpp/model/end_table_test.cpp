// SPDX-License-Identifier: Apache-2.0
// The lists of what refers to a particle, against a twin of pairs.
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace iota::model {
namespace {

using ingredient::Bond;
using ingredient::Bonds;
using ingredient::spring_law;

std::set<std::uint32_t> bonds_of(const Model& model, std::uint32_t p) {
  std::set<std::uint32_t> found;
  model.bonds.for_each_of(p, [&](std::uint32_t bond) { EXPECT_TRUE(found.insert(bond).second) << "listed twice"; });
  return found;
}

TEST(Adjacency, lists_agree_with_a_twin_through_random_bonds) {
  std::mt19937 random(6);
  SmallModel m;
  std::vector<std::uint32_t> particles;
  for (int i = 0; i < 12; ++i) particles.push_back(m.particle(m.body({{double(i), 0, 0}}), 0));
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> twin;
  for (int i = 0; i < 2000; ++i) {
    if (twin.empty() || random() % 2 == 0) {
      Bond bond;
      bond.p = particles[random() % 12], bond.q = particles[random() % 12];
      if (bond.p == bond.q) continue;
      const std::uint64_t revision = m.model.bonds_revision;
      twin[Bonds::add(m.model, bond)] = {bond.p, bond.q};
      EXPECT_GT(m.model.bonds_revision, revision);
    } else {
      const auto victim = std::next(twin.begin(), static_cast<std::ptrdiff_t>(random() % twin.size()));
      Bonds::remove(m.model, victim->first);
      twin.erase(victim);
    }
    for (const std::uint32_t p : particles) {
      std::set<std::uint32_t> expected;
      for (const auto& [bond, ends] : twin)
        if (ends.first == p || ends.second == p) expected.insert(bond);
      ASSERT_EQ(bonds_of(m.model, p), expected);
      ASSERT_EQ(m.model.particles[p].uses, expected.size());
    }
  }
  EXPECT_EQ(m.model.laws[spring_law].uses, twin.size());
  EXPECT_TRUE(ingredient::validate(m.model).empty());
}

TEST(Adjacency, redirected_uses_go_to_the_survivor_and_those_between_the_two_end) {
  SmallModel m;
  std::vector<std::uint32_t> p;
  for (int i = 0; i < 3; ++i) p.push_back(m.particle(m.body({{double(i), 0, 0}}), 0));
  const auto bond = [&](std::uint32_t a, std::uint32_t b) {
    Bond made;
    made.p = a, made.q = b;
    return Bonds::add(m.model, made);
  };
  const std::uint32_t between = bond(p[0], p[1]), kept = bond(p[1], p[2]), other = bond(p[2], p[0]);
  m.model.absorb_uses(p[1], p[0]);
  EXPECT_FALSE(m.model.bonds.is_alive(between));
  EXPECT_EQ(m.model.bonds[kept].p, p[0]);
  EXPECT_EQ(bonds_of(m.model, p[0]), (std::set{kept, other}));
  EXPECT_TRUE(bonds_of(m.model, p[1]).empty());
  EXPECT_EQ(m.model.particles[p[1]].uses, 0u);
  EXPECT_TRUE(ingredient::validate(m.model).empty());
}

TEST(Adjacency, a_bond_may_be_removed_while_its_particles_bonds_are_visited) {
  SmallModel m;
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0), q = m.particle(m.body({{1, 0, 0}}), 0);
  for (int i = 0; i < 5; ++i) {
    Bond made;
    made.p = p, made.q = q;
    Bonds::add(m.model, made);
  }
  int visited = 0;
  m.model.bonds.for_each_of(p, [&](std::uint32_t bond) { ++visited, Bonds::remove(m.model, bond); });
  EXPECT_EQ(visited, 5);
  EXPECT_EQ(m.model.bonds.size(), 0u);
  EXPECT_TRUE(ingredient::validate(m.model).empty());
}

TEST(Adjacency, a_bond_is_muted_while_one_of_its_ends_does_not_act) {
  SmallModel m;
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0), q = m.particle(m.body({{1, 0, 0}}), 0);
  Bond made;
  made.p = p, made.q = q;
  const std::uint32_t bond = Bonds::add(m.model, made);
  EXPECT_TRUE(m.model.bonds[bond].acts());
  m.model.particles[q].inactive = 1, m.model.acting_changed(q);
  EXPECT_FALSE(m.model.bonds[bond].acts());
  m.model.particles[q].inactive = 0, m.model.acting_changed(q);
  EXPECT_TRUE(m.model.bonds[bond].acts());
}

}  // namespace
}  // namespace iota::model
