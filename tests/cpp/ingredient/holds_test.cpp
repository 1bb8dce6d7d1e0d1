// SPDX-License-Identifier: Apache-2.0
// Which ingredients keep a lone particle from flying freely.
#include "ingredient/ingredient_list.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

bool is_held(const model::Model& model, std::uint32_t particle) {
  bool held = false;
  for_each_type<Ingredients>([&]<class I>() { held = held || I::holds(model, particle); });
  return held;
}

struct TwoParticles {
  model::SmallModel m;
  std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0), q = m.particle(m.body({{1, 0, 0}}), 0);
};

TEST(Holds, nothing_holds_a_particle_by_itself) {
  const TwoParticles two;
  EXPECT_FALSE(is_held(two.m.model, two.p));
}

TEST(Holds, a_closing_holds_both_its_particles) {
  TwoParticles two;
  (void)Closings::add(two.m.model, {{two.p, two.q}, 1, 1, 0, 0});
  EXPECT_TRUE(Closings::holds(two.m.model, two.p) && Closings::holds(two.m.model, two.q));
}

TEST(Holds, a_bond_holds_where_it_is_solved_implicitly_and_acts) {
  TwoParticles two;
  ingredient::Bond bond;
  bond.p = two.p, bond.q = two.q;
  const std::uint32_t slot = Bonds::add(two.m.model, bond);
  EXPECT_TRUE(is_held(two.m.model, two.q));
  two.m.model.bonds[slot].implicit = 0;
  EXPECT_FALSE(is_held(two.m.model, two.q));
  two.m.model.bonds[slot].implicit = 1, two.m.model.bonds[slot].active = 0;
  EXPECT_FALSE(is_held(two.m.model, two.q));
}

TEST(Holds, a_grip_holds_the_particles_of_its_body) {
  TwoParticles two;
  ingredient::Grip grip;
  grip.body = two.m.model.particles[two.p].body;
  (void)two.m.model.grips.create(grip);
  EXPECT_TRUE(is_held(two.m.model, two.p));
  EXPECT_FALSE(is_held(two.m.model, two.q));
}

}  // namespace
}  // namespace iota::ingredient
