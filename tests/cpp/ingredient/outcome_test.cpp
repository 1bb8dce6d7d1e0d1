// SPDX-License-Identifier: Apache-2.0
#include "ingredient/outcome.h"

#include "ingredient/model.h"
#include "shape/shape.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <limits>

namespace iota::ingredient {
namespace {

/// Two particles, with what a test adds.
struct Two {
  model::SmallModel m;
  model::Model& model = m.model;
  std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0), q = m.particle(m.body({{1, 0, 0}}), 0);
  Outcome outcome;

  Outcome& told() {
    tell(model, outcome);
    return outcome;
  }
};

TEST(Outcome, of_a_step_in_which_nothing_happened_is_empty) {
  Two s;
  EXPECT_FALSE(s.told().has_edits());
  EXPECT_TRUE(s.outcome.stops.empty() && s.outcome.warnings.empty());
}

TEST(Outcome, names_a_particle_whose_lifetime_is_over_and_leaves_it_alive) {
  Two s;
  model::Attributes a;
  a.particle = s.p, a.lifetime = 0.2;
  s.model.particles[s.p].attributes = s.model.attributes.create(a).slot;
  end_step(s.model, 0.125);
  EXPECT_TRUE(s.told().ended.empty());
  end_step(s.model, 0.125);
  EXPECT_EQ(s.told().ended, std::vector<ParticleId>{s.model.particles.id(s.p)});
  EXPECT_EQ(s.told().ended.size(), 1u) << "it is told anew, not added";
  EXPECT_TRUE(s.model.particles.is_alive(s.p));
}

TEST(Outcome, names_an_emitter_that_owes_a_birth_and_not_one_that_is_off) {
  Two s;
  Emitter e;
  e.source = shape::to_data(Sphere{0.1});
  e.rate = 10, e.mass = 1, e.max_count = 9, e.lifetime = 100;
  const EmitterId on = s.model.emitters.create(e);
  e.active = 0;
  const EmitterId off = s.model.emitters.create(e);
  end_step(s.model, 0.0625);
  EXPECT_TRUE(s.told().due.empty());
  for (int i = 0; i < 3; ++i) end_step(s.model, 0.0625);
  EXPECT_EQ(s.told().due, std::vector<EmitterId>{on});
  std::vector<ParticleId> born;
  Emitters::bear(s.model, on.slot, 0.0625, born);
  EXPECT_EQ(born.size(), 2u);
  EXPECT_EQ(s.model.emitters[on.slot].due, 0.5);
  EXPECT_EQ(s.model.emitters[off.slot].due, 0);
  EXPECT_TRUE(s.told().due.empty());
}

TEST(Outcome, names_a_closing_whose_time_is_over) {
  Two s;
  const std::uint32_t closing = Closings::add(s.model, {{s.p, s.q}, 1, 0.2});
  end_step(s.model, 0.125);
  EXPECT_TRUE(s.told().met.empty());
  end_step(s.model, 0.125);
  ASSERT_EQ(s.told().met.size(), 1u);
  EXPECT_EQ(s.outcome.met[0], s.model.closings.id(closing));
}

TEST(Outcome, names_a_bond_above_its_breaking_force_as_soon_as_it_has_one) {
  Two s;
  Bond bond;
  bond.p = s.p, bond.q = s.q, bond.implicit = 0, bond.held_force = {3, 0, 0};
  const std::uint32_t slot = Bonds::add(s.model, bond);
  EXPECT_TRUE(s.told().overloaded.empty());
  s.model.bonds[slot].break_force = 2.5, ++s.model.bonds_revision;
  ASSERT_EQ(s.told().overloaded.size(), 1u);
  EXPECT_EQ(s.outcome.overloaded[0].bond, s.model.bonds.id(slot));
  EXPECT_EQ(s.outcome.overloaded[0].force, 3);
  EXPECT_EQ(s.outcome.overloaded[0].position, (Vec3{0.5, 0, 0}));
  EXPECT_TRUE(s.model.bonds[slot].active);
  s.model.bonds[slot].break_force = 3.5;
  EXPECT_FALSE(s.told().has_edits());
}

}  // namespace
}  // namespace iota::ingredient
