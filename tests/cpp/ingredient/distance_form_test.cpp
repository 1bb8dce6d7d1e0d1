// SPDX-License-Identifier: Apache-2.0
#include "ingredient/distance_form.h"

#include "ingredient/joint_readings.h"
#include "tests/cpp/ingredient/joint_values.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace iota::ingredient {
namespace {

TEST(DistanceForm, a_rod_and_a_rope_have_one_row_that_counts_from_their_length) {
  for (const ConstraintKind kind : {ConstraintKind::rod, ConstraintKind::rope}) {
    TwoBlocks blocks;
    Model& model = blocks.m.model;
    const std::uint32_t joint = make_constraint(
        model, DistanceSpec{.kind = kind, .p = blocks.particle(blocks.a, 0), .q = blocks.particle(blocks.b, 0)});
    EXPECT_EQ(values_of(model, joint).held, std::vector<double>{0}) << "5 m, as they are";
    model.constraints[joint].length = 4;
    EXPECT_NEAR(values_of(model, joint).worst(), (25 - 16) / 8.0, 1e-12) << "(|d|^2 - L^2) / 2L";
    model.constraints[joint].compliance.linear = 1e-3;
    EXPECT_NEAR(values_of(model, joint).worst(), 1, 1e-12) << "a compliant one is stretched by its excess length";
  }
}

TEST(DistanceForm, a_row_follows_a_changed_length) {
  TwoBlocks blocks;
  Constraint c;
  c.length = 3;
  solver::DistanceConstraint rod;
  solver::BilinearConstraint rope;
  solver::SpanConstraint compliant;
  joint::DistanceForm::load(rod, blocks.m.model, c, nullptr);
  joint::DistanceForm::load(rope, blocks.m.model, c, nullptr);
  joint::DistanceForm::load(compliant, blocks.m.model, c, nullptr);
  EXPECT_EQ(rod.length, 3);
  EXPECT_EQ(rope.product, 9);
  EXPECT_EQ(compliant.target, 3);
  EXPECT_FALSE(compliant.is_moving());
  joint::move_target(compliant, -0.5);
  EXPECT_EQ(compliant.target_start, 3.5);
  EXPECT_TRUE(compliant.is_moving());
}

TEST(DistanceForm, a_line_that_was_hauled_has_the_distance_itself_as_its_row) {
  for (const ConstraintKind kind : {ConstraintKind::rod, ConstraintKind::rope}) {
    TwoBlocks blocks;
    Model& model = blocks.m.model;
    const std::uint32_t joint = make_constraint(
        model, DistanceSpec{.kind = kind, .p = blocks.particle(blocks.a, 0), .q = blocks.particle(blocks.b, 0)});
    model.constraints[joint].is_hauled = 1, model.constraints[joint].length = 4;
    EXPECT_NEAR(values_of(model, joint).worst(), 1, 1e-12);
  }
}

TEST(DistanceForm, a_length_that_is_to_run_stores_energy_as_where_it_starts) {
  TwoBlocks blocks;
  Model& model = blocks.m.model;
  const std::uint32_t joint = make_constraint(
      model,
      DistanceSpec{.kind = ConstraintKind::rod, .p = blocks.particle(blocks.a, 0), .q = blocks.particle(blocks.b, 0)});
  Constraint& c = model.constraints[joint];
  c.compliance.linear = 0.5, c.length = 4.5, c.way = 0.25;
  EXPECT_NEAR(calc_energy_of_holds(model, joint), 0.75 * 0.75, 1e-12) << "half of 2 N/m, 0.75 m beyond 4.25 m";
}

TEST(DistanceForm, a_span_holds_nothing_and_is_a_slide) {
  TwoBlocks blocks;
  const std::uint32_t span = make_constraint(
      blocks.m.model,
      SpanSpec{
          .p = blocks.particle(blocks.a, 0), .q = blocks.particle(blocks.b, 0), .slide = {.upper = 6}, .breaks = {}});
  const JointValues values = values_of(blocks.m.model, span);
  EXPECT_TRUE(values.held.empty());
  EXPECT_EQ(values.coordinates, 1);
  EXPECT_NEAR(calc_coordinate(blocks.m.model, span, JointCoordinate::slide).first, 5, 1e-12);
}

TEST(DistanceForm, two_particles_of_one_body_are_refused) {
  TwoBlocks blocks;
  EXPECT_THROW((void)make_constraint(blocks.m.model, DistanceSpec{.kind = ConstraintKind::rope,
                                                                  .p = blocks.particle(blocks.a, 0),
                                                                  .q = blocks.particle(blocks.a, 1)}),
               std::invalid_argument);
}

}  // namespace
}  // namespace iota::ingredient
