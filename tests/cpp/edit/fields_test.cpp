// SPDX-License-Identifier: Apache-2.0
#include "edit/fields.h"
#include "tests/cpp/refused.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace iota {
namespace {

TEST(Group, has_a_name_of_its_own_and_there_are_only_so_many) {
  System system;
  const GroupId red = system.groups().create("red");
  expect_refused(system, [&] { system.groups().create(""); }, "needs a name");
  expect_refused(system, [&] { system.groups().create("red"); }, "there is a group 'red' already");
  std::size_t count = 1;
  try {
    for (;; ++count) system.groups().create("group " + std::to_string(count));
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("at most " + std::to_string(count)), std::string::npos) << error.what();
  }
  system.groups().destroy(red);
  EXPECT_NO_THROW(system.groups().create("red"));
}

TEST(Group, that_takes_the_place_of_another_does_not_take_its_members) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {});
  const GroupId first = system.groups().create("first");
  system.groups().add(first, p);
  EXPECT_TRUE(system.groups().contains(first, p));
  system.groups().destroy(first);
  EXPECT_FALSE(system.groups().contains(system.groups().create("second"), p));
}

TEST(Group, on_which_something_acts_is_not_destroyed) {
  System system;
  const GroupId first = system.groups().create("first"), second = system.groups().create("second");
  const FieldId wind = system.fields().create("wind", {.group = first});
  expect_refused(system, [&] { system.groups().destroy(first); }, "field 0 acts on it");
  system.fields().destroy(wind);
  const PairsId pairs = system.pairs().create({system.laws().find("soft_repulsion"), {{"length", 1}}, {}},
                                              {.cutoff = 1, .group = first, .other = second});
  for (const GroupId group : {first, second})
    expect_refused(system, [&] { system.groups().destroy(group); }, "pairwise force 0 acts on it");
  system.pairs().destroy(pairs);
  system.groups().destroy(first), system.groups().destroy(second);
}

TEST(Field, without_such_a_name_or_parameter_is_refused_with_those_that_there_are) {
  System system;
  expect_refused(system, [&] { system.fields().create("wnd"); }, "wind");
  expect_refused(system, [&] { system.fields().create("fx = nothing; fy = 0; fz = 0"); }, "nothing");
  const FieldId wind = system.fields().create("wind");
  EXPECT_EQ(system.fields().name(wind), "wind");
  EXPECT_THROW(system.fields().set_parameter(wind, "nothing", 1), std::invalid_argument);
}

TEST(Pairs, that_lack_the_data_of_their_law_are_refused) {
  System system;
  const GroupId group = system.groups().create("group");
  const LawId soft = system.laws().find("soft_repulsion");
  const LawId code = system.laws().create([](double r, double, double, const double*) { return -r; });
  const auto refused = [&](const SharedLaw& law, const PairsOptions& options, const char* words) {
    expect_refused(system, [&] { system.pairs().create(law, options); }, words);
  };
  refused({soft, {{"length", 1}}, {}}, {.cutoff = 0}, "cutoff");
  refused({code, {}, {}}, {.cutoff = 1}, "take a predefined law or an expression");
  refused({soft, {{"length", 1}}, {}}, {.cutoff = 1, .other = group}, "need both");
  refused({system.laws().find("spring"), {}, {}}, {.cutoff = 1}, "need a value for length");
}

}  // namespace
}  // namespace iota
