// SPDX-License-Identifier: Apache-2.0
#include "edit/bonds.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace iota {
namespace {

struct TwoPoints {
  System system{SystemOptions{.gravity = {}}};
  ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
  ParticleId q = system.particles().create(system.bodies().create(), {3, 4, 0});
};

TEST(Bond, without_a_length_has_that_of_its_ends_when_it_is_made) {
  TwoPoints two;
  const BondId bond = two.system.bonds().create(two.p, two.q, SpringLaw{.stiffness = 100});
  double length = 0;
  for (const LawParameter& parameter : two.system.bonds().parameters(bond))
    if (parameter.name == "length") length = parameter.value;
  EXPECT_NEAR(length, 5, 1e-14);
  (void)two.system.step(0.01);
  EXPECT_LT(norm(two.system.bonds().force(bond)), 1e-10);
}

TEST(Bond, of_one_particle_or_of_numbers_out_of_range_is_refused_and_changes_nothing) {
  TwoPoints two;
  Bonds bonds = two.system.bonds();
  const BondId bond = bonds.create(two.p, two.q, SpringLaw{.stiffness = 100});
  const LawId code = two.system.laws().create([](double r, double, double, const double*) { return -r; });
  const std::uint64_t before = two.system.state_hash();
  EXPECT_THROW(bonds.create(two.p, two.p, SpringLaw{}), std::invalid_argument);
  EXPECT_THROW(bonds.create(two.p, two.q, SpringLaw{.stiffness = -1}), std::invalid_argument);
  EXPECT_THROW(bonds.create(two.p, two.q, (SharedLaw{code, {}, true})), std::invalid_argument) << "no derivative";
  EXPECT_THROW(bonds.set_parameter(bond, "stiffness", -1), std::invalid_argument);
  EXPECT_THROW(bonds.set_parameter(bond, "nothing", 1), std::invalid_argument);
  EXPECT_THROW(bonds.set_break_force(bond, -1), std::invalid_argument);
  EXPECT_THROW(bonds.set_break_force(bond, std::nan("")), std::invalid_argument);
  EXPECT_EQ(two.system.state_hash(), before);
}

TEST(Bond, that_is_switched_off_pulls_no_more_and_pulls_again_when_it_is_switched_on) {
  TwoPoints two;
  const BondId bond = two.system.bonds().create(two.p, two.q, SpringLaw{.stiffness = 100, .length = 4});
  const auto pull = [&] {
    (void)two.system.step(1e-6);
    return norm(two.system.bonds().force(bond));
  };
  EXPECT_NEAR(pull(), 100, 1e-3);
  two.system.bonds().set_active(bond, false);
  EXPECT_EQ(pull(), 0);
  two.system.bonds().set_active(bond, true);
  EXPECT_NEAR(pull(), 100, 1e-3);
}

}  // namespace
}  // namespace iota
