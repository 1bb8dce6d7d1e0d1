// SPDX-License-Identifier: Apache-2.0
#include "solver/constraints/surface_pair.h"

#include "shape/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace iota::solver {
namespace {

double gap(const Shape& a, const Shape& b, const Vec3& apart) {
  const auto surface_a = shape::make_surface(a), surface_b = shape::make_surface(b);
  SurfacePairConstraint c;
  c.surface_a = surface_a.get(), c.surface_b = surface_b.get();
  c.set_constant(0, apart);
  for (int k = 0; k < 3; ++k)
    for (const int first : {1, 4}) c.set_constant(first + k, {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0});
  c.start(nullptr, 0);
  double g = 0;
  c.value(nullptr, 0, &g);
  return g;
}

TEST(SurfacePair, has_the_gap_of_closed_forms_apart_and_overlapping) {
  for (const double d : {0.5, 0.8, 2.0}) {
    EXPECT_NEAR(gap(Sphere{0.5}, Sphere{0.3}, {0, d, 0}), d - 0.8, 1e-12);
    EXPECT_NEAR(gap(Ellipsoid{{1, 0.4, 0.6}}, HalfSpace{{0, -1, 0}}, {0.1, d, 0.3}), d - 0.2, 1e-12)
        << "from below a ceiling";
    EXPECT_NEAR(gap(Capsule{0.2, 0.8}, Sphere{0.1}, {0.1, 0.1 + d, 0}), 0.1 + d - 0.3, 1e-12);
  }
}

TEST(SurfacePair, has_the_gap_of_closed_forms_at_sharp_edges_corners_and_tips) {
  const double far = std::sqrt(2.0) * 0.5;  // from the middle of an edge
  for (const double d : {0.02, 0.3}) {
    EXPECT_NEAR(gap(Box{}, Sphere{0.1}, {0.5 + 0.1 + d, 0.1, 0.2}), d, 1e-9) << "a face";
    EXPECT_NEAR(gap(Box{}, Sphere{0.1}, (far + 0.1 + d) / std::sqrt(2.0) * Vec3{1, 1, 0}), d, 1e-9) << "an edge";
    EXPECT_NEAR(gap(Box{}, Sphere{0.1}, (std::sqrt(0.75) + 0.1 + d) / std::sqrt(3.0) * Vec3{1, 1, 1}), d, 1e-9)
        << "a corner";
    EXPECT_NEAR(gap(Cylinder{0.5, 1}, Sphere{0.1}, {0.5 + 0.1 + d, 0.2, 0}), d, 1e-9) << "an end";
    EXPECT_NEAR(gap(Cylinder{0.5, 1}, Sphere{0.1}, {0.1, 0.5 + 0.1 + d, 0}), d, 1e-9) << "the side";
    EXPECT_NEAR(gap(Cylinder{0.5, 1}, Sphere{0.1}, (far + 0.1 + d) / std::sqrt(2.0) * Vec3{1, 0, 1}), d, 1e-9)
        << "a rim";
    EXPECT_NEAR(gap(Cone{0.5, 1}, Sphere{0.1}, {0.5 + 0.1 + d, 0, 0}), d, 1e-9) << "the tip";
    EXPECT_NEAR(gap(Cone{0.5, 1}, HalfSpace{{1, 0, 0}}, {-0.5 - d, 0, 0}), d, 1e-9) << "the base on a wall";
  }
}

}  // namespace
}  // namespace iota::solver
