// SPDX-License-Identifier: Apache-2.0
#include "tests/cpp/amount.h"
#include "tests/cpp/expression/evaluated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace iota::expression {
namespace {

std::string error_of(const std::string& text) {
  Formula f(inputs);
  try {
    (void)parse(text, f);
  } catch (const ExpressionError& error) {
    return error.what();
  }
  return "no error";
}

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

TEST(Expression, errors_offer_the_names_that_are_possible_there) {
  const auto message = [](const char* text) {
    Formula f({"r", "cos_p"}, {"cos_p"});
    try {
      (void)parse(text, f);
    } catch (const ExpressionError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message("y = x").find("unknown name 'x'. Known are r\n"), std::string::npos) << message("y = x");
  EXPECT_NE(message("y = x*cos_p").find("Known are r, cos_p\n"), std::string::npos) << message("y = x*cos_p");
}

TEST(Expression, refuses_a_parameter_that_the_text_does_not_have) {
  const std::string names[] = {"k", "z0"};
  require_mentioned("y = k*r + z0", names);
  for (const char* text : {"y = k*r", "y = k*z01 + az0"})
    EXPECT_THROW(require_mentioned(text, names), std::invalid_argument);
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

TEST(Expression, no_text_crashes_the_parser) {
  std::mt19937 random(3);
  const std::string alphabet = "rvk 0123456789.+-*/^()<>=,;\nesinqrtwhab$\xc3\xbc";
  int parsed = 0;
  const int rounds = sampled(30000);
  for (int round = 0; round < rounds; ++round) {
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
  EXPECT_GT(parsed, rounds / 10) << "texts that are whole still parse";
}

}  // namespace
}  // namespace iota::expression
