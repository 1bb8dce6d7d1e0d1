// SPDX-License-Identifier: Apache-2.0
#include "ingredient/surface_form.h"

#include "ingredient/joint_readings.h"
#include "shape/shape.h"
#include "tests/cpp/ingredient/joint_values.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace iota::ingredient {
namespace {

PlacedSurface placed(const Shape& shape, const Vec3& position) { return {{shape::to_data(shape)}, position, {}}; }

TEST(SurfaceForm, the_row_is_the_level_of_the_particle) {
  TwoBlocks blocks;
  const std::uint32_t joint =
      make_constraint(blocks.m.model, SurfaceConstraintData{.kind = ConstraintKind::outside,
                                                            .particle = blocks.particle(blocks.a, 0),
                                                            .body = {},
                                                            .surface = placed(Sphere{2}, {3, 0, 0}),
                                                            .breaks = {}});
  ASSERT_EQ(values_of(blocks.m.model, joint).held.size(), 1u);
  EXPECT_NEAR(values_of(blocks.m.model, joint).held[0], (9 - 4) / 4.0, 1e-12) << "(d^2 - R^2) / 2R";
  blocks.move(blocks.a, {2, 0, 0});
  EXPECT_NEAR(values_of(blocks.m.model, joint).held[0], (1 - 4) / 4.0, 1e-12) << "inside";
}

TEST(SurfaceForm, a_particle_stays_on_no_sharp_edge) {
  TwoBlocks blocks;
  EXPECT_THROW((void)make_constraint(blocks.m.model, SurfaceConstraintData{.kind = ConstraintKind::surface,
                                                                           .particle = blocks.particle(blocks.a, 0),
                                                                           .body = {},
                                                                           .surface = placed(Box{}, {}),
                                                                           .breaks = {}}),
               std::invalid_argument);
}

TEST(SurfaceForm, two_surfaces_start_from_their_nearest_points) {
  TwoBlocks blocks;
  Model& model = blocks.m.model;
  const std::uint32_t joint =
      make_constraint(model, SurfacePairData{.kind = ConstraintKind::apart,
                                             .a = model.bodies.id(blocks.a),
                                             .b = model.bodies.id(blocks.b),
                                             .surfaces = {placed(Sphere{1}, {0, 0, 0}), placed(Sphere{1.5}, {5, 0, 0})},
                                             .breaks = {}});
  start_rows(model, joint);
  ASSERT_EQ(values_of(model, joint).held.size(), 1u);
  EXPECT_NEAR(values_of(model, joint).held[0], 2.5, 1e-9);
  blocks.move(blocks.b, {-3, 0, 0});
  EXPECT_NEAR(values_of(model, joint).held[0], -0.5, 1e-9) << "they overlap";
}

}  // namespace
}  // namespace iota::ingredient
