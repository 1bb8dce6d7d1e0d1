// SPDX-License-Identifier: Apache-2.0
#include "ingredient/coupling_form.h"

#include "ingredient/joints.h"
#include "ingredient/tables.h"
#include "tests/cpp/ingredient/joint_values.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace iota::ingredient {
namespace {

/// Three blocks, tied by two spans, whose sum is coupled with ratios 1 and 2.
struct Coupled {
  TwoBlocks blocks;
  std::uint32_t third = blocks.m.body({{0, 3, 0}, {1, 3, 0}, {0, 4, 0}, {0, 3, 1}});
  std::uint32_t to_b = span(blocks.b), to_third = span(third);
  std::uint32_t coupling = make_constraint(model(), CouplingSpec{.terms = {term(to_b, 1), term(to_third, 2)}});

  Model& model() { return blocks.m.model; }
  std::uint32_t span(std::uint32_t to) {
    return make_constraint(
        model(), SpanSpec{.p = blocks.particle(blocks.a, 0), .q = blocks.particle(to, 0), .slide = {}, .breaks = {}});
  }
  CoupledCoordinate term(std::uint32_t joint, double ratio) {
    return {model().constraints.id(joint), JointCoordinate::slide, ratio};
  }
  std::optional<solver::CouplingConstraint> row() {
    IslandNodes nodes;
    std::vector<std::uint32_t> node_of_ring(model().rings.slot_count(), none), articulates;
    for (const std::uint32_t body : {blocks.a, blocks.b, third}) articulates.push_back(model().bodies[body].articulate);
    nodes.build(model(), articulates, node_of_ring);
    const IslandMap map(model(), nodes, nodes.bodies, node_of_ring);
    return joint::CouplingForm::row_of(map, model().constraints[coupling]);
  }
};

TEST(CouplingForm, the_row_is_the_weighted_sum_of_its_joints_coordinates) {
  Coupled c;
  EXPECT_EQ(c.model().constraints[c.coupling].length, 5 + 2 * 3) << "as they are";
  const auto row = c.row();
  ASSERT_TRUE(row);
  EXPECT_EQ(row->count, 3u) << "the three ends of the spans";
  ASSERT_EQ(row->terms.size(), 2u);
  EXPECT_EQ(row->terms[1].ratio, 2);
  EXPECT_EQ(joint::CouplingForm::calc_violation(c.model(), c.model().constraints[c.coupling]).absolute, 0);
  c.blocks.move(c.third, {0, 0.5, 0});
  EXPECT_NEAR(joint::CouplingForm::calc_violation(c.model(), c.model().constraints[c.coupling]).absolute, 1, 1e-12);
}

TEST(CouplingForm, there_is_no_row_while_one_of_its_joints_is_switched_off) {
  Coupled c;
  c.model().constraints[c.to_third].active = 0;
  EXPECT_FALSE(c.row());
}

TEST(CouplingForm, an_upper_bound_is_violated_from_above_only) {
  Coupled c;
  Constraint rope = c.model().constraints[c.coupling];
  rope.kind = ConstraintKind::tackle;
  c.blocks.move(c.third, {0, -1, 0});
  EXPECT_EQ(joint::CouplingForm::calc_violation(c.model(), rope).absolute, 0) << "slack";
  c.blocks.move(c.third, {0, 2, 0});
  EXPECT_NEAR(joint::CouplingForm::calc_violation(c.model(), rope).absolute, 2, 1e-12);
}

TEST(CouplingForm, goes_with_the_first_of_its_joints_and_leaves_no_term) {
  Coupled c;
  EXPECT_EQ(c.model().coupled_terms.size(), 2u);
  Joints::destroy(c.model(), c.to_b);
  EXPECT_FALSE(c.model().constraints.is_alive(c.coupling));
  EXPECT_EQ(c.model().coupled_terms.size(), 0u);
  EXPECT_EQ(c.model().constraints[c.to_third].coupled, none);
  EXPECT_EQ(validate(c.model()), std::vector<std::string>{});
}

TEST(CouplingForm, a_term_that_is_in_no_list_is_found) {
  Coupled c;
  c.model().constraints[c.to_third].coupled = none;
  EXPECT_FALSE(validate(c.model()).empty());
}

}  // namespace
}  // namespace iota::ingredient
