// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_rows.h"

#include "tests/cpp/ingredient/joint_values.h"

#include <gtest/gtest.h>

#include <limits>

namespace iota::ingredient {
namespace {

using namespace joint;

TEST(JointRows, a_coordinate_has_a_row_for_each_option_that_is_set) {
  EXPECT_EQ(rows_of({}), RowsOf{});
  EXPECT_EQ(rows_of({.lower = -1}), (RowsOf{true, false, false, false}));
  EXPECT_EQ(rows_of({.motor_speed = 1}), RowsOf{}) << "a motor without a force";
  EXPECT_EQ(rows_of({.motor_max = 2, .friction = 3}), (RowsOf{false, true, true, false}));
  EXPECT_EQ(rows_of({.damping = 4}), (RowsOf{false, false, false, true}));
}

TEST(JointRows, rows_that_hold_number_their_multipliers_one_after_the_other) {
  Constraint c;
  c.options[slide] = {.lower = 0, .friction = 1};
  std::vector<RowUse> uses;
  auto sink = [&](const auto&, RowUse use) { uses.push_back(use); };
  RowSink out(c, sink);
  out.hold(solver::AffineConstraint{});
  out.coordinate(slide, solver::SpanConstraint{});
  out.hold(solver::BilinearConstraint{}, angle);
  ASSERT_EQ(uses.size(), 4u);
  EXPECT_EQ(uses[0].first, 0);
  EXPECT_EQ(uses[1].role, Role::limit);
  EXPECT_EQ(uses[2].role, Role::friction);
  EXPECT_EQ(uses[3].first, 3) << "after three of the first row";
  EXPECT_EQ(uses[3].coordinate, angle);
}

TEST(JointRows, the_law_of_a_row_has_the_sign_of_its_kind_and_its_compliance) {
  Constraint c;
  c.kind = ConstraintKind::rope;
  EXPECT_EQ(law_of_hold(c, {}, solver::SpanConstraint{}).lower, 0) << "a rope pulls only";
  c.kind = ConstraintKind::outside;
  EXPECT_EQ(law_of_hold(c, {}, solver::SurfaceConstraint{}).upper, 0) << "a surface pushes only";
  c.kind = ConstraintKind::weld;
  c.compliance = {.linear = 2, .angular = 3, .time = 4};
  EXPECT_EQ(law_of_hold(c, {.coordinate = slide}, solver::AffineConstraint{}).compliance, 2);
  solver::BilinearConstraint turn;
  turn.reference = 10;
  const solver::RowLaw law = law_of_hold(c, {.coordinate = angle}, turn);
  EXPECT_EQ(law.compliance, 300) << "a lever of 10 m";
  EXPECT_EQ(law.damping, 4.0 / 300);
}

TEST(JointRows, places_are_nodes_and_those_of_the_world_constants) {
  TwoBlocks blocks;
  JointSpec spec = blocks.spec(ConstraintKind::ball);
  spec.b = {};
  const std::uint32_t joint = make_constraint(blocks.m.model, spec);
  const JointPlaces places(blocks.m.model, blocks.m.model.constraints[joint]);
  EXPECT_EQ(places.arms[a_origin].nodes[0], (std::pair<std::uint32_t, double>{a_origin, 1}));
  EXPECT_LT(norm(places.position[a_origin] - spec.at), 1e-12);
  EXPECT_EQ(places.arms[b_origin].nodes[0].second, 0);
  EXPECT_EQ(places.arms[b_origin].constant, spec.at);
}

}  // namespace
}  // namespace iota::ingredient
