// SPDX-License-Identifier: Apache-2.0
#include "edit/laws.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace iota {
namespace {

struct PairOnX {
  System system{SystemOptions{.gravity = {}}};
  ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
  ParticleId q = system.particles().create(system.bodies().create(), {3, 0, 0});
};

TEST(Law, is_destroyed_only_when_nothing_uses_it) {
  PairOnX two;
  const LawId law = two.system.laws().create("energy = k * r^2", {"square", {{"k", 3}}});
  const BondId bond = two.system.bonds().create(two.p, two.q, SharedLaw{law, {}, true});
  const PairsId pairs = two.system.pairs().create({law, {}, {}}, {.cutoff = 2});
  for (const char* const uses : {"2", "1"}) {
    try {
      two.system.laws().destroy(law);
      FAIL();
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("the law square cannot be destroyed: "), std::string::npos) << text;
      EXPECT_NE(text.find(std::string(uses) + " bond"), std::string::npos) << text;
      EXPECT_NE(text.find("pairwise force"), std::string::npos) << text;
    }
    if (two.system.bonds().contains(bond)) two.system.bonds().destroy(bond);
  }
  two.system.pairs().destroy(pairs);
  two.system.laws().destroy(law);
  EXPECT_FALSE(two.system.laws().contains(law));
}

TEST(Law, that_is_predefined_stays) {
  System system;
  EXPECT_THROW(system.laws().destroy(system.laws().find("soft_repulsion")), std::invalid_argument);
  EXPECT_NO_THROW((void)system.laws().find("soft_repulsion"));
}

}  // namespace
}  // namespace iota
