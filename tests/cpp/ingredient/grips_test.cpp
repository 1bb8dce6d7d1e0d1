// SPDX-License-Identifier: Apache-2.0
#include "ingredient/grips.h"
#include "ingredient/attachments.h"
#include "ingredient/tables.h"
#include "tests/cpp/ingredient/collected_loads.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace iota::ingredient {
namespace {

/// A grip at `place` of a body.
std::uint32_t hold(model::Model& model, std::uint32_t body, const Vec3& place) {
  ingredient::Grip grip;
  grip.body = body;
  Grips::anchor(model, grip, place);
  return model.grips.create(grip).slot;
}

// Against a walk through all.
TEST(Grips, are_found_by_their_body_in_the_order_of_slots) {
  BodyTable<Grip, GripId> grips;
  std::mt19937 random(2);
  for (int round = 0; round < 500; ++round) {
    const std::uint32_t body = random() % 5, slot = grips.slot_count() > 0 ? random() % grips.slot_count() : 0;
    if (random() % 2)
      (void)grips.create({.body = body});
    else if (grips.is_alive(slot))
      random() % 2 ? grips.destroy(slot) : grips.move(slot, body);
    for (std::uint32_t b = 0; b < 5; ++b) {
      std::vector<std::uint32_t> expected, found;
      grips.for_each([&](std::uint32_t s, const Grip& g) {
        if (g.body == b) expected.push_back(s);
      });
      grips.for_each_of(b, [&](std::uint32_t s, const Grip&) { found.push_back(s); });
      ASSERT_EQ(found, expected) << round;
      ASSERT_EQ(grips.has_any(b), !expected.empty()) << round;
    }
  }
}

TEST(Grips, hold_the_nearest_place_between_the_ends_of_a_rod) {
  model::SmallModel m;
  const std::uint32_t grip = hold(m.model, m.body({{1, 0, 0}, {2, 0, 0}}), {1.25, 3, 0});
  EXPECT_EQ(Grips::point(m.model, m.model.grips[grip]), (Vec3{1.25, 0, 0}));
}

TEST(Grips, follow_the_particle_that_they_are_nearest_to) {
  model::SmallModel m;
  const auto rods = m.chain(2);
  const std::uint32_t left = hold(m.model, rods[0], {0.25, 0, 0}), right = hold(m.model, rods[1], {1.75, 0, 0});

  Attachments joined(m.model, rods);  // two bodies become one
  RestructureReport report;
  (void)model::combine_bodies(m.model, rods[0], rods[1], report);
  joined.reattach(m.model);
  EXPECT_EQ(m.model.grips[right].body, rods[0]);
  EXPECT_LT(norm(Grips::point(m.model, m.model.grips[right]) - Vec3{1.75, 0, 0}), 1e-12);
  EXPECT_EQ(ingredient::validate(m.model), std::vector<std::string>{});

  Attachments apart(m.model, std::array{rods[0]});  // and one leaves it again, as another body
  report = {};
  (void)model::separate_part(m.model, rods[0], m.model.particles[m.particle(rods[0], 2)].part, report);
  apart.reattach(m.model);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  EXPECT_EQ(m.model.grips[left].body, rods[0]);
  EXPECT_EQ(m.model.grips[right].body, report.created_bodies[0].slot);
  EXPECT_EQ(ingredient::validate(m.model), std::vector<std::string>{});
}

TEST(Grips, go_with_their_body) {
  model::SmallModel m;
  const auto rods = m.chain(2);
  (void)hold(m.model, rods[0], {0.25, 0, 0});
  const std::uint32_t other = hold(m.model, rods[1], {1.75, 0, 0});
  Attachments attachments(m.model, std::array{rods[0]});
  model::destroy_body(m.model, rods[0]);
  attachments.reattach(m.model);
  EXPECT_EQ(m.model.grips.size(), 1u);
  EXPECT_TRUE(m.model.grips.is_alive(other));
  EXPECT_EQ(ingredient::validate(m.model), std::vector<std::string>{});
}

TEST(Grips, take_the_points_of_a_new_basis_without_moving) {
  model::SmallModel m;
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}});
  const std::uint32_t grip = hold(m.model, body, {0.75, 0, 0});
  (void)m.model.make_particle(body, {4, 0, 0}, 1, {});
  m.model.rebuild_basis(body);
  prepare(m.model, body);
  EXPECT_EQ(m.model.grips[grip].points[1], m.particle(body, 2));
  EXPECT_LT(norm(Grips::point(m.model, m.model.grips[grip]) - Vec3{0.75, 0, 0}), 1e-12);
}

TEST(Grips, pull_at_the_points_that_carry_them_and_count_for_the_part_that_they_hold) {
  model::SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {4, 0, 0}});
  const std::uint32_t p = m.particle(rod, 0), q = m.particle(rod, 1);
  const BodyId other_part = m.model.bodies.id(m.body({{9, 9, 9}}));
  m.model.particles[q].part = other_part;
  m.model.grips[hold(m.model, rod, {3, 0, 0})].force = {0, 4, 0};
  const CollectedLoads<Grips> loads(m.model, rod);
  EXPECT_LT(norm(loads.on(p, Load::Kind::outside) - Vec3{0, 1, 0}), 1e-12);
  EXPECT_LT(norm(loads.on(q, Load::Kind::outside) - Vec3{0, 3, 0}), 1e-12);
  for (const Load& load : loads.list) EXPECT_EQ(load.part, other_part);
}

}  // namespace
}  // namespace iota::ingredient
