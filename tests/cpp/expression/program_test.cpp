// SPDX-License-Identifier: Apache-2.0
#include "expression/program.h"
#include "expression/functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace iota::expression {
namespace {

const std::vector<std::string> inputs{"r", "v", "k", "length"};

/// Slow twin: walks the graph node by node.
double walk(const Formula& f, Node node, const std::vector<double>& at) {
  const Formula::Entry& e = f[node];
  if (e.op == Op::constant) return e.value;
  if (e.op == Op::input) return at[e.a];
  if (e.op == Op::whole_power) return apply(e.op, walk(f, e.a, at), e.value, 0);
  const double a = walk(f, e.a, at);
  const double b = e.op >= Op::add ? walk(f, e.b, at) : 0;
  const double c = e.op == Op::select ? walk(f, e.c, at) : 0;
  return apply(e.op, a, b, c);
}

double value_of(const std::string& text, const std::vector<double>& at = {2, 3, 5, 7}) {
  Formula f(inputs);
  return walk(f, parse("y = " + text, f).front().node, at);
}

std::string error_of(const std::string& text) {
  Formula f(inputs);
  try {
    (void)parse(text, f);
  } catch (const ExpressionError& error) {
    return error.what();
  }
  return "no error";
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

TEST(Expression, follows_the_usual_rules_of_precedence) {
  EXPECT_EQ(value_of("1 + 2*3 - 4/8"), 6.5);
  EXPECT_EQ(value_of("-r^2"), -4);
  EXPECT_EQ(value_of("2^-1 + 2**3"), 8.5);
  EXPECT_EQ(value_of("2^3^2"), 512);
  EXPECT_EQ(value_of("(1 + r)*k"), 15);
  EXPECT_EQ(value_of("10 - 3 - 2"), 5);
  EXPECT_EQ(value_of("where(r < v, k, length) + (r >= 2) + step(-1) + (v > 3)"), 6);
  EXPECT_EQ(value_of("1.5e1 + .5"), 15.5);
  EXPECT_EQ(value_of("max(r, v) + min(r, v)*10 + abs(-1) + sign(-3) + floor(2.5)"), 25);
  EXPECT_NEAR(value_of("sin(pi/6) + pow(r, 0.5) - sqrt(2)"), 0.5, 1e-15);
}

TEST(Expression, definitions_may_use_earlier_ones) {
  Formula f(inputs);
  const auto all = parse("s = r - length;\n energy = 0.5*k*s^2\n\n force = -k*s;", f);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].name, "energy");
  EXPECT_EQ(walk(f, all[1].node, {9, 0, 5, 7}), 10);
}

TEST(Expression, errors_point_at_the_place_and_suggest) {
  EXPECT_EQ(error_of("energy = 0.5*k*(r - lenght)^2"),
            "expression, at character 21: unknown name 'lenght'; did you mean 'length'? Known are r, v, k, length\n"
            "  energy = 0.5*k*(r - lenght)^2\n"
            "                      ^");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "no expression"},
      {"r*k", "expected 'name = expression'"},
      {"y = ", "ends too early"},
      {"y = 2 r", "not expected here"},
      {"y = 2r", "needs a '*'"},
      {"y = (r + 1", "never closed"},
      {"y = r + 1)", "no '(' for this"},
      {"y = sqtr(r)", "did you mean 'sqrt'?"},
      {"y = sqrt(r, v)", "takes 1 argument, not 2"},
      {"y = sqrt()", "takes 1 argument, not 0"},
      {"y = sqrt + 1", "is a function: write sqrt(...)"},
      {"y = r < v < k", "cannot be chained"},
      {"y = r == v", "comparisons are"},
      {"y = 1e999", "too large"},
      {"y = 1.2.3", "not a number"},
      {"r = 2", "already"},
      {"sin = 2", "meaning already"},
      {"y = r; y = v", "defined twice"},
      {"y = r $ v", "'$' is not expected"},
      {"y = r \xc3\xb7 v", "plain letters"},
      {"y = " + std::string(200, '(') + "r" + std::string(200, ')'), "nested deeper than 100"},
      {"y = " + std::string(200, '-') + "r", "nested deeper than 100"},
      {"y = q; q = r", "unknown name 'q'"},
  };
  for (const auto& [text, wanted] : cases)
    EXPECT_NE(error_of(text).find(wanted), std::string::npos) << text << "\n" << error_of(text);
}

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

/// A random text over the grammar; `depth` levels.
std::string random_text(std::mt19937& random, int depth) {
  const auto pick = [&](auto... words) {
    const std::vector<std::string> list{words...};
    return list[random() % list.size()];
  };
  if (depth == 0) return pick("r", "v", "k", "length", "0", "1", "2.5", "0.5", "pi");
  const auto part = [&] { return random_text(random, depth - 1); };
  switch (random() % 8) {
    case 0: return "(" + part() + pick(" + ", " - ", "*", "/") + part() + ")";
    case 1: return "(" + part() + ")^" + pick("2", "-3", "12", "0.5", "(r)");
    case 2:
      return pick("sqrt", "exp", "log", "sin", "cos", "tan", "tanh", "abs", "sign", "floor", "step") + "(" + part() +
             ")";
    case 3: return pick("min", "max", "pow") + "(" + part() + ", " + part() + ")";
    case 4: return "where(" + part() + " < " + part() + ", " + part() + ", " + part() + ")";
    case 5: return "-" + part();
    default: return part() + pick(" + ", " - ", "*", "/") + part();
  }
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

TEST(Expression, no_text_crashes_the_parser) {
  std::mt19937 random(3);
  const std::string alphabet = "rvk 0123456789.+-*/^()<>=,;\nesinqrtwhab$\xc3\xbc";
  int parsed = 0;
  for (int round = 0; round < 30000; ++round) {
    std::string text = random_text(random, static_cast<int>(random() % 4));
    for (unsigned edits = random() % 4; edits > 0 && !text.empty(); --edits) {
      const std::size_t at = random() % text.size();
      if (random() % 2)
        text.erase(at, 1 + random() % 3);
      else
        text.insert(at, 1, alphabet[random() % alphabet.size()]);
    }
    Formula f(inputs);
    try {
      parsed += parse("y = " + text, f).size() > 0;
    } catch (const ExpressionError& error) {
      EXPECT_LE(error.position, text.size() + 4);
    }
  }
  EXPECT_GT(parsed, 3000) << "texts that are whole still parse";
}

}  // namespace
}  // namespace iota::expression
