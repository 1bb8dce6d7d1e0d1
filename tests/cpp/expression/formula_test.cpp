// SPDX-License-Identifier: Apache-2.0
#include "tests/cpp/expression/evaluated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace iota::expression {
namespace {

TEST(Expression, derivatives_agree_with_differences) {
  for (const std::string text :
       {"r^3 - 2/r", "exp(-r*k)*sin(v*r)", "sqrt(r^2 + v^2)", "log(r)*tanh(r - v)", "pow(r, v)", "pow(k, r)",
        "tan(r/3)", "where(r < 2.2, r^2, 5*r)", "min(r^2, 10*r) + max(r, -r) + abs(r - 9)", "cos(r)^-3",
        "4*k*((v/r)^12 - (v/r)^6)", "r^1.5", "r^-0.5", "floor(r) + sign(r) + step(r) + r"}) {
    Formula f(inputs);
    const Node y = parse("y = " + text, f).front().node;
    for (std::uint32_t input = 0; input < 3; ++input) {
      const Node slope = f.derivative(y, input);
      std::vector<double> at{1.3, 0.7, 0.4, 2}, up = at, down = at;
      const double d = 1e-6;
      up[input] += d, down[input] -= d;
      const double difference = (walk(f, y, up) - walk(f, y, down)) / (2 * d);
      EXPECT_NEAR(walk(f, slope, at), difference, 1e-7 * (1 + std::abs(difference))) << text << " by " << inputs[input];
    }
  }
}

TEST(Expression, second_derivatives_of_a_spring_are_its_stiffness) {
  Formula f(inputs);
  const Node y = parse("y = 0.5*k*(r - length)^2", f).front().node;
  const Node curvature = f.derivative(f.derivative(y, 0), 0);
  EXPECT_EQ(walk(f, curvature, {1.7, 0, 250, 1}), 250);
}

}  // namespace
}  // namespace iota::expression
