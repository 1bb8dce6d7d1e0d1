// SPDX-License-Identifier: Apache-2.0
#include "shape/surface.h"

#include "shape/shape.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::shape {
namespace {

TEST(Surface, whose_function_fails_is_nowhere_from_then_on_and_says_why) {
  for (const bool throws : {true, false}) {
    int calls = 0;
    const FunctionSurface broken(
        [&](const Vec3& p) -> double {
          if (++calls == 25 && throws) throw std::runtime_error("no");
          return calls < 25 ? p.x : std::nan("");
        },
        1);
    EXPECT_EQ(broken.at({2, 0, 0}).value, 2);
    EXPECT_EQ(broken.failure(), "");
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(broken.at({2, 0, 0}).value, 0);
      EXPECT_EQ(norm(broken.at({2, 0, 0}).gradient), 0);
      EXPECT_EQ(broken.failure(), throws ? "raised: no" : "is not finite");
    }
    EXPECT_LT(calls, 40) << "it is not called again";
  }
  EXPECT_EQ(FunctionSurface(nullptr, 1).failure(), "has no function in this system");
}

TEST(Surface, is_refused_where_a_shape_has_none_that_is_smooth) {
  EXPECT_THROW((void)make_surface(Mesh{}), std::invalid_argument);
  EXPECT_THROW((void)make_surface(Sphere{-1}), std::invalid_argument);
  EXPECT_THROW((void)make_surface(HalfSpace{{0, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(FunctionSurface([](const Vec3&) { return 0.0; }, 0), std::invalid_argument);
}

}  // namespace
}  // namespace iota::shape
