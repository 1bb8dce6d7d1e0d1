// SPDX-License-Identifier: Apache-2.0
// Which particles go with which piece when cosmetic bonds break.
#include "ingredient/quantities.h"
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace iota::model {
namespace {

std::uint32_t join(Model& model, std::uint32_t p, std::uint32_t q) {
  ingredient::CosmeticBond bond;
  bond.p = p, bond.q = q;
  return ingredient::CosmeticBonds::add(model, bond);
}

/// The particles that bonds connect with p, by a search.
std::set<std::uint32_t> reach(const Model& model, std::uint32_t p) {
  std::set<std::uint32_t> found{p};
  std::vector<std::uint32_t> open{p};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    model.cosmetic_bonds.for_each([&](std::uint32_t, const ingredient::CosmeticBond& bond) {
      if (model.particles[bond.p].body != model.particles[bond.q].body) return;
      for (const auto& [from, to] : {std::pair{bond.p, bond.q}, std::pair{bond.q, bond.p}})
        if (from == at && found.insert(to).second) open.push_back(to);
    });
  }
  return found;
}

TEST(SplitByBonds, agrees_with_a_search_through_random_graphs) {
  std::mt19937 random(11);
  int splits = 0;
  for (int round = 0; round < 60; ++round) {
    SmallModel m;
    std::vector<Vec3> places;
    for (int i = 0; i < 8; ++i) places.push_back({double(i), 0.3 * double(random() % 5), 0.2 * double(random() % 7)});
    const std::uint32_t body = m.body(places);
    std::vector<std::uint32_t> p, bonds;
    for (int i = 0; i < 8; ++i) p.push_back(m.particle(body, i));
    for (int i = 1; i < 8; ++i) bonds.push_back(join(m.model, p[i], p[random() % static_cast<unsigned>(i)]));
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t a = random() % 8, b = random() % 8;
      if (a != b) bonds.push_back(join(m.model, p[a], p[b]));
    }
    std::shuffle(bonds.begin(), bonds.end(), random);
    for (const std::uint32_t bond : bonds) {
      const std::uint32_t first = m.model.cosmetic_bonds[bond].p, second = m.model.cosmetic_bonds[bond].q;
      const std::uint32_t home = m.model.particles[first].body;
      RestructureReport report;
      (void)ingredient::CosmeticBonds::break_(m.model, bond, report);
      const std::set<std::uint32_t> stays = reach(m.model, first);
      const bool apart = !stays.contains(second);
      ASSERT_EQ(report.created_bodies.size(), apart ? 1u : 0u);
      ASSERT_EQ(m.model.particles[first].body, home) << "the first end stays";
      for (const std::uint32_t particle : reach(m.model, second))
        ASSERT_EQ(m.model.particles[particle].body, apart ? report.created_bodies[0].slot : home);
      ASSERT_TRUE(ingredient::validate(m.model).empty());
      splits += apart;
    }
  }
  EXPECT_EQ(splits, 60 * 7) << "each body ends as eight";
}

TEST(SplitByBonds, leaves_positions_velocities_and_masses_as_they_are) {
  SmallModel m;
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {6, 1, 0}});
  std::vector<std::uint32_t> p;
  for (int i = 0; i < 4; ++i) p.push_back(m.particle(body, i));
  join(m.model, p[0], p[1]), join(m.model, p[2], p[3]);
  const std::uint32_t bridge = join(m.model, p[1], p[2]);
  for (std::size_t i = 0; i < 4; ++i) m.model.rings[m.model.particles[p[i]].ring].velocity = {double(i), 1, 2};
  const Vec3 momentum = ingredient::calc_momenta(m.model).linear, angular = ingredient::calc_momenta(m.model).angular;
  const double energy = ingredient::calc_energies(m.model).kinetic;
  RestructureReport report;
  const Edit edit = ingredient::CosmeticBonds::break_(m.model, bridge, report);
  EXPECT_FALSE(edit.moved);
  EXPECT_EQ(ingredient::calc_momenta(m.model).linear, momentum);
  EXPECT_EQ(ingredient::calc_momenta(m.model).angular, angular);
  EXPECT_EQ(ingredient::calc_energies(m.model).kinetic, energy);
}

TEST(SplitByBonds, never_makes_a_body_without_mass) {
  SmallModel m;
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}});
  const std::uint32_t marker = m.model.make_marker(body, {0.5, 0, 0});
  join(m.model, m.particle(body, 0), m.particle(body, 1));
  const std::uint32_t bond = join(m.model, m.particle(body, 0), marker);
  RestructureReport report;
  (void)ingredient::CosmeticBonds::break_(m.model, bond, report);
  EXPECT_TRUE(report.created_bodies.empty());
  EXPECT_EQ(report.notes.size(), 1u);
  EXPECT_TRUE(ingredient::validate(m.model).empty());
}

}  // namespace
}  // namespace iota::model
