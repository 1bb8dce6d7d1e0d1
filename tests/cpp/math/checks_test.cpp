// SPDX-License-Identifier: Apache-2.0
#include "math/checks.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

namespace iota {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

std::string refusal(const std::function<void()>& check) {
  try {
    check();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(Checks, name_the_argument_and_its_value) {
  EXPECT_EQ(refusal([] { require_size("the radius", -2); }), "the radius must be above 0 and at most 1e9 m, got -2");
  EXPECT_EQ(refusal([] { require_finite("position", {1, 2e9, 3}); }),
            "position must have no component above 1e9, got (1, 2e+09, 3)");
}

TEST(Checks, take_the_limits_and_refuse_what_is_beyond_them_or_no_number) {
  for (const double good : {1e-30, 1.0, 1e15}) EXPECT_EQ(refusal([&] { require_mass("mass", good); }), "") << good;
  for (const double bad : {0.0, -1.0, 0.9e-30, 1.1e15, infinity, nan})
    EXPECT_NE(refusal([&] { require_mass("mass", bad); }), "") << bad;
  for (const double bad : {-1e-300, infinity, nan})
    EXPECT_NE(refusal([&] { require_not_negative("damping", bad); }), "") << bad;
  EXPECT_EQ(refusal([] { require_not_negative("damping", 0); }), "");
  for (const double bad : {0.0, 1.1e9, infinity, nan})
    EXPECT_NE(refusal([&] { require_size("size", bad); }), "") << bad;
  EXPECT_EQ(refusal([] { require_size("size", 1e9); }), "");
  EXPECT_EQ(refusal([] { require_break_force(infinity); }), "") << "it never breaks";
  for (const double bad : {0.0, -1.0, nan}) EXPECT_NE(refusal([&] { require_break_force(bad); }), "") << bad;
  for (const double bad : {1.1e9, -1.1e9, infinity, nan})
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 v;
      (axis == 0 ? v.x : axis == 1 ? v.y : v.z) = bad;
      EXPECT_NE(refusal([&] { require_finite("velocity", v); }), "") << axis << ' ' << bad;
    }
}

TEST(Checks, give_the_unit_quaternion_of_a_direction_and_refuse_zero) {
  const Quaternion q = require_quaternion("orientation", {0, 0, 3, 4});
  EXPECT_NEAR(q.z, 0.6, 1e-15);
  EXPECT_NEAR(q.w, 0.8, 1e-15);
  EXPECT_NE(refusal([] { (void)require_quaternion("orientation", {0, 0, 0, 0}); }), "");
  EXPECT_NE(refusal([] { (void)require_quaternion("orientation", {0, nan, 0, 1}); }), "");
}

}  // namespace
}  // namespace iota
