// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pin_form.h"

#include "ingredient/joint_readings.h"
#include "tests/cpp/ingredient/joint_values.h"

#include <gtest/gtest.h>

#include <map>

namespace iota::ingredient {
namespace {

TEST(PinForm, rows_of_a_new_joint_are_met_and_as_many_as_it_takes_degrees_of_freedom) {
  const std::map<ConstraintKind, std::size_t> taken{
      {ConstraintKind::ball, 3},        {ConstraintKind::universal, 4}, {ConstraintKind::revolute, 5},
      {ConstraintKind::cylindrical, 4}, {ConstraintKind::prismatic, 5}, {ConstraintKind::orientation, 3},
      {ConstraintKind::weld, 6},        {ConstraintKind::screw, 5},     {ConstraintKind::planar, 3}};
  for (const auto& [kind, rows] : taken) {
    TwoBlocks blocks;
    JointSpec spec = blocks.spec(kind);
    spec.lead = 0.1;
    const std::uint32_t joint = make_constraint(blocks.m.model, spec);
    const JointValues values = values_of(blocks.m.model, joint);
    EXPECT_EQ(values.held.size(), rows) << info(kind).name;
    EXPECT_LT(values.worst(), 1e-12) << info(kind).name;
    EXPECT_EQ(values.coordinates, 0);
  }
}

TEST(PinForm, a_plate_and_a_solid_are_welded_by_six_rows_in_either_order) {
  for (const bool plate_first : {true, false}) {
    TwoBlocks blocks;
    const std::uint32_t plate = blocks.m.body({{9, 0, 0}, {10, 0, 0}, {9, 0, 1}});  // it holds z and x, not y
    JointSpec spec = blocks.spec(ConstraintKind::weld);
    spec.at = {9.5, 0, 0};
    (plate_first ? spec.a : spec.b) = blocks.m.model.bodies.id(plate);
    const std::uint32_t weld = make_constraint(blocks.m.model, spec);
    EXPECT_EQ(values_of(blocks.m.model, weld).held.size(), 6u);
    EXPECT_LT(values_of(blocks.m.model, weld).worst(), 1e-12);
  }
}

TEST(PinForm, what_a_joint_leaves_free_changes_no_row) {
  TwoBlocks blocks;
  const std::uint32_t rail = make_constraint(blocks.m.model, blocks.spec(ConstraintKind::prismatic));
  blocks.move(blocks.a, {0, 0, 0.5});
  EXPECT_LT(values_of(blocks.m.model, rail).worst(), 1e-12);
  EXPECT_NEAR(calc_coordinate(blocks.m.model, rail, JointCoordinate::slide).first, 0.5, 1e-12);
  blocks.move(blocks.a, {0, 0.25, 0});
  EXPECT_NEAR(values_of(blocks.m.model, rail).worst(), 0.25, 1e-12) << "across the axis";
}

TEST(PinForm, a_slide_is_measured_along_the_side_that_holds_its_line) {
  TwoBlocks blocks;
  JointSpec spec = blocks.spec(ConstraintKind::prismatic);
  spec.b = {};
  const std::uint32_t rail = make_constraint(blocks.m.model, spec);
  EXPECT_TRUE(blocks.m.model.constraints[rail].line_side);
  EXPECT_TRUE(blocks.m.model.constraints[rail].has(b_axis));
}

TEST(PinForm, each_option_of_a_coordinate_is_a_row) {
  TwoBlocks blocks;
  JointSpec spec = blocks.spec(ConstraintKind::cylindrical);
  spec.angle = {.lower = -1, .friction = 1}, spec.slide = {.stiffness = 5};
  EXPECT_EQ(values_of(blocks.m.model, make_constraint(blocks.m.model, spec)).coordinates, 3);
}

TEST(PinForm, a_line_that_rubs_holds_the_same_and_leaves_the_slide_free) {
  TwoBlocks blocks;
  JointSpec spec = blocks.spec(ConstraintKind::prismatic);
  spec.slide = {.friction_coefficient = 0.5};
  const std::uint32_t rail = make_constraint(blocks.m.model, spec);
  EXPECT_EQ(values_of(blocks.m.model, rail).held.size(), 6u) << "one of them along the axis";
  EXPECT_LT(calc_violation(blocks.m.model, rail).absolute, 1e-12);
  blocks.move(blocks.a, {0, 0, 0.5});
  EXPECT_LT(calc_violation(blocks.m.model, rail).absolute, 1e-12);
  blocks.move(blocks.a, {0, 0.25, 0});
  EXPECT_NEAR(calc_violation(blocks.m.model, rail).absolute, 0.25, 1e-12) << "across the axis";
}

}  // namespace
}  // namespace iota::ingredient
