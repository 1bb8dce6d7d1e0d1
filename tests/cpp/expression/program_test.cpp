// SPDX-License-Identifier: Apache-2.0
#include "expression/program.h"

#include "tests/cpp/expression/evaluated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace iota::expression {
namespace {

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

TEST(Expression, elementary_functions_are_accurate) {
  std::mt19937_64 random(1);
  const auto relative = [](double a, double b) { return std::abs(a - b) / std::abs(b); };
  for (int i = 0; i < 200000; ++i) {
    const double u = std::uniform_real_distribution(-1.0, 1.0)(random);
    const double x = std::ldexp(u, static_cast<int>(random() % 40) - 30);
    EXPECT_LT(std::abs(x) < 700 ? relative(exp(x), std::exp(x)) : 0, 4e-16) << x;
    EXPECT_LT(std::abs(log(std::abs(x)) - std::log(std::abs(x))), 4e-16 * (std::abs(std::log(std::abs(x))) + 1e-3))
        << x;
    EXPECT_LT(std::abs(sin(x) - std::sin(x)), 3e-16) << x;
    EXPECT_LT(std::abs(cos(x) - std::cos(x)), 3e-16) << x;
    EXPECT_LT(relative(tanh(x), std::tanh(x)), 6e-16) << x;
    EXPECT_LT(relative(tan(x), std::tan(x)), 1e-15 + 1e-15 * std::abs(std::tan(x))) << x;
    const double a = std::abs(x) + 1e-3, b = 5 * u;
    EXPECT_LT(relative(pow(a, b), std::pow(a, b)), 4e-16 * (2 + std::abs(b * std::log(a)))) << a << "^" << b;
  }
  EXPECT_LT(std::abs(sin(123456789.0) - std::sin(123456789.0)), 1e-15);
}

TEST(Expression, elementary_functions_know_their_ends) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  EXPECT_EQ(exp(-800), 0);
  EXPECT_EQ(exp(800), infinity);
  EXPECT_EQ(exp(0), 1);
  EXPECT_EQ(exp(-infinity), 0);
  EXPECT_GT(exp(-744.4), 0);
  EXPECT_EQ(log(0), -infinity);
  EXPECT_EQ(log(infinity), infinity);
  EXPECT_EQ(log(1), 0);
  EXPECT_NEAR(log(5e-324), std::log(5e-324), 1e-12);
  EXPECT_EQ(tanh(400), 1);
  EXPECT_EQ(tanh(-400), -1);
  EXPECT_EQ(tanh(0), 0);
  EXPECT_EQ(pow(0, 2.5), 0);
  EXPECT_EQ(pow(0, -1), infinity);
  EXPECT_EQ(pow(7, 0), 1);
  EXPECT_NEAR(pow(-2, 3), -8, 1e-14);
  EXPECT_NEAR(pow(-2, 4), 16, 1e-14);
  for (const double x : {log(-1), pow(-2, 0.5), sin(infinity), cos(2e9), exp(nan), log(nan), sin(nan), tanh(nan)})
    EXPECT_TRUE(std::isnan(x));
}

TEST(Expression, programs_agree_bit_by_bit_with_their_slow_twin) {
  std::mt19937 random(7);
  Program::Workspace workspace;
  for (int round = 0; round < 400; ++round) {
    Formula f(inputs);
    const Node y = parse("y = " + random_text(random, 1 + round % 4), f).front().node;
    const std::vector<Node> outputs{y, f.derivative(y, 0), f.derivative(f.derivative(y, 0), 0)};
    const std::vector<bool> uniform{false, round % 2 == 0, true, round % 3 == 0};
    const Program program(f, outputs, uniform);
    constexpr std::size_t n = 150;
    std::vector<std::vector<double>> in(4, std::vector<double>(n)), out(3, std::vector<double>(n));
    std::vector<double> uniforms(4);
    for (std::size_t i = 0; i < 4; ++i) {
      for (double& x : in[i]) x = std::uniform_real_distribution(-3.0, 3.0)(random);
      uniforms[i] = in[i][0];
      if (uniform[i]) std::fill(in[i].begin(), in[i].end(), uniforms[i]);
    }
    const double* lanes[4] = {in[0].data(), in[1].data(), in[2].data(), in[3].data()};
    double* results[3] = {out[0].data(), out[1].data(), out[2].data()};
    program.run(n, lanes, uniforms.data(), results, workspace);
    for (std::size_t lane = 0; lane < n; lane += 7) {
      const std::vector<double> at{in[0][lane], in[1][lane], in[2][lane], in[3][lane]};
      double one[3];
      program.run_one(at.data(), one, workspace);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_TRUE(same_bits(out[k][lane], one[k]));
        EXPECT_TRUE(same_bits(walk(f, outputs[k], at), one[k])) << walk(f, outputs[k], at) << " " << one[k];
      }
    }
  }
}

}  // namespace
}  // namespace iota::expression
