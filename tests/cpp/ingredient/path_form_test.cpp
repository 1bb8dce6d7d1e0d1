// SPDX-License-Identifier: Apache-2.0
#include "ingredient/path_form.h"

#include "ingredient/joint_readings.h"
#include "tests/cpp/ingredient/joint_values.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

/// A corner of a block on a line along x in the world, from x = -2 to 2.
struct OnLine {
  TwoBlocks blocks;
  std::uint32_t joint = make_constraint(blocks.m.model, PathSpec{.particle = blocks.particle(blocks.a, 0),
                                                                 .body = {},
                                                                 .curve = CurveKind::polyline,
                                                                 .points = {{-2, 0, 0}, {2, 0, 0}}});
  Model& model() { return blocks.m.model; }
};

TEST(PathForm, a_particle_on_the_curve_meets_two_rows_and_its_slide_is_the_length_to_it) {
  OnLine on;
  EXPECT_EQ(values_of(on.model(), on.joint).held.size(), 2u);
  EXPECT_LT(values_of(on.model(), on.joint).worst(), 1e-12);
  EXPECT_NEAR(calc_coordinate(on.model(), on.joint, JointCoordinate::slide).first, 2, 1e-12);
  EXPECT_EQ(on.model().constraints[on.joint].options[1].upper, 4) << "an open path ends at its ends";
  on.blocks.move(on.blocks.a, {1, 0, 0});
  EXPECT_LT(values_of(on.model(), on.joint).worst(), 1e-12);
  on.blocks.move(on.blocks.a, {0, 0.5, 0});
  EXPECT_NEAR(values_of(on.model(), on.joint).worst(), 0.5, 1e-9);
}

TEST(PathForm, the_force_is_kept_while_the_normals_of_the_row_may_change) {
  OnLine on;
  Constraint& c = on.model().constraints[on.joint];
  const joint::JointPlaces places(on.model(), c);
  c.multipliers = {0, 3, -4};
  auto sink = [&]<class Row>(const Row& row, RowUse use) {
    if (use.role != joint::Role::hold) return;
    Row loaded = row;
    double multipliers[Row::rows];
    joint::load_hold(loaded, on.model(), c, use, multipliers);
    c.multipliers = {};
    joint::store_hold(loaded, c, use, multipliers);
  };
  joint::build_rows({c, on.model().geometry(on.joint), places.arms}, sink);
  EXPECT_LT(norm(Vec3{c.multipliers[0], c.multipliers[1], c.multipliers[2]} - Vec3{0, 3, -4}), 1e-12);
}

}  // namespace
}  // namespace iota::ingredient
