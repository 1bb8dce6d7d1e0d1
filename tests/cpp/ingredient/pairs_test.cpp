// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pairs.h"

#include "ingredient/tables.h"
#include "tests/cpp/ingredient/everything.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace iota::ingredient {
namespace {

using model::Everything;

bool complains(const Everything& e, const std::string& text) {
  const auto complaints = validate(e.model);
  return std::any_of(complaints.begin(), complaints.end(),
                     [&](const std::string& c) { return c.find(text) != std::string::npos; });
}

TEST(Pairs, need_a_law_with_a_derivative_groups_that_live_and_a_cut_off) {
  const Everything whole;
  const auto damaged = [&](auto damage, const char* text) {
    Everything e = whole;
    damage(e.model.pairs[e.pairs]);
    EXPECT_TRUE(complains(e, text)) << text;
  };
  damaged([](PairForce& p) { p.law = 1000; }, "has no living law");
  damaged([](PairForce& p) { p.law = scripted_law; }, "has no living law");
  damaged([](PairForce& p) { p.group = 30; }, "acts on no living group");
  damaged([](PairForce& p) { p.other = 30; }, "acts on no living group");
  damaged([](PairForce& p) { p.cutoff = 0; }, "has cut-off 0");
  damaged([](PairForce& p) { p.cutoff = std::numeric_limits<double>::infinity(); }, "has cut-off inf");
}

TEST(Pairs, come_back_from_bytes_with_all_that_they_are) {
  Everything e;
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  e.model.archive(writer);
  model::Model again;
  Reader reader(bytes);
  again.archive(reader);
  ASSERT_TRUE(reader.ok());
  const PairForce &before = e.model.pairs[e.pairs], &after = again.pairs[e.pairs];
  EXPECT_EQ(after.law, before.law);
  EXPECT_EQ(after.cutoff, 0.5);
  EXPECT_EQ(after.parameters, before.parameters);
}

// The force of a pair is minus the slope of its energy, by finite differences from outside.
TEST(Pairs, push_by_the_slope_of_their_energy) {
  const auto energy_at = [](double distance) {
    System system({.gravity = {}});
    for (const double x : {0.0, distance}) system.particles().create(system.bodies().create(), {x, 0, 0});
    const PairsId pairs =
        system.pairs().create({system.laws().find("soft_repulsion"), {{"length", 0.5}}, {}}, {.cutoff = 0.5});
    const double energy = system.pairs().energy(pairs);
    (void)system.step(1e-6);
    return std::pair{energy, system.particles().net_force(system.particles().ids()[1]).x};
  };
  for (const double distance : {0.1, 0.25, 0.4}) {
    const double slope = (energy_at(distance + 1e-5).first - energy_at(distance - 1e-5).first) / 2e-5;
    EXPECT_NEAR(energy_at(distance).second, -slope, 1e-5 * std::abs(slope)) << distance;
    EXPECT_LT(slope, 0);
  }
  EXPECT_EQ(energy_at(0.6).first, 0);
  EXPECT_EQ(energy_at(0.6).second, 0);
}

}  // namespace
}  // namespace iota::ingredient
