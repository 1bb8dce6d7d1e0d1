// SPDX-License-Identifier: Apache-2.0
// Membership: who is in which body, ring and articulate.
#include "ingredient/tables.h"
#include "shape/shape.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <limits>

namespace iota::model {
namespace {

const std::vector<std::string> whole;

TEST(Model, that_is_new_is_empty_and_whole) {
  const Model model;
  EXPECT_EQ(ingredient::validate(model), whole);
  EXPECT_EQ(model.particles.size() + model.bodies.size() + model.articulates.size(), 0u);
  EXPECT_EQ(model.laws.size(), static_cast<std::uint32_t>(laws::pair_law_count) + 1)
      << "the listed ones and `scripted`";
}

TEST(Model, puts_each_new_body_into_an_articulate_and_each_new_particle_into_a_ring_of_its_own) {
  SmallModel m;
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(m.model.articulates.size(), 1u);
  EXPECT_EQ(m.model.rings.size(), 3u);
  EXPECT_EQ(m.model.bodies[body].count, 3u);
  std::vector<double> along_x;
  m.model.for_each_particle_of(body, [&](std::uint32_t p) { along_x.push_back(m.model.position(p).x); });
  EXPECT_EQ(along_x, (std::vector<double>{0, 1, 0})) << "in the order in which they were made";
  EXPECT_EQ(ingredient::validate(m.model), whole);
}

TEST(Model, destroys_a_ring_and_its_records_with_its_last_particle) {
  SmallModel m;
  const auto chain = m.chain(2);
  const std::uint32_t p = m.particle(chain[0], 1), q = m.particle(chain[1], 0), ring = m.model.particles[p].ring;
  ASSERT_EQ(m.model.particles[q].ring, ring);
  m.model.nails.make(ring), m.model.pushes.make(ring);
  m.model.take_from_ring(p);
  EXPECT_TRUE(m.model.rings.is_alive(ring)) << "q is still in it";
  m.model.take_from_ring(q);
  EXPECT_FALSE(m.model.rings.is_alive(ring));
  EXPECT_TRUE(m.model.nails.is_empty() && m.model.pushes.is_empty());
}

TEST(Model, removes_a_particle_with_its_inertia_solid_twin_fuse_and_attributes) {
  SmallModel m;
  Model& model = m.model;
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
  const std::uint32_t p = m.particle(body, 1), other = m.particle(body, 4);
  InertiaPair pair;
  pair.body = body, pair.p = m.particle(body, 0), pair.q = p, pair.inertia = 0.1;
  model.bodies[body].first_inertia = model.inertia_pairs.create(pair).slot;
  Solid solid;
  solid.body = body;
  solid.shape = shape::to_data(Sphere{0.1});
  for (int i = 0; i < 4; ++i) solid.points[static_cast<std::size_t>(i)] = m.particle(body, i);
  model.bodies[body].first_solid = model.solids.create(solid).slot;
  Twin twin;
  twin.particle = p;
  model.add_twin(twin);
  model.set_fuse(p, 7), model.set_fuse(other, 8);
  Attributes attributes;
  attributes.particle = p;
  model.particles[p].attributes = model.attributes.create(attributes).slot;
  ASSERT_EQ(ingredient::validate(model), whole);

  model.remove_particle(p);
  model.rebuild_basis(body);
  EXPECT_EQ(model.inertia_pairs.size() + model.solids.size() + model.twins.size() + model.attributes.size(), 0u);
  EXPECT_FALSE(model.fuses.has(p));
  EXPECT_EQ(model.fuses[other], 8) << "the others keep theirs";
  EXPECT_EQ(ingredient::validate(model), whole);
}

TEST(Model, forgets_a_fuse_that_never_blows) {
  SmallModel m;
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0);
  m.model.set_fuse(p, 5);
  EXPECT_TRUE(m.model.fuses.has(p));
  m.model.set_fuse(p, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(m.model.fuses.has(p));
}

TEST(Survivors, are_found_through_any_number_of_absorptions_while_the_last_one_lives) {
  SmallModel m;
  std::vector<ParticleId> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(m.model.particles.id(m.particle(m.body({{double(i), 0, 0}}), 0)));
  for (int i = 0; i < 3; ++i) {
    m.model.record_survivor(ids[i], ids[i + 1]);
    const std::uint32_t body = m.model.particles[ids[i].slot].body;
    m.model.remove_particle(ids[i].slot);
    m.model.remove_body(body);
  }
  EXPECT_EQ(m.model.survivor_of(ids[0]), ids[3]);
  EXPECT_EQ(m.model.survivor_of(ids[3]), ids[3]) << "itself while it lives";
  destroy_particle(m.model, ids[3].slot);
  EXPECT_EQ(m.model.survivor_of(ids[0]), std::nullopt);
  EXPECT_EQ(m.model.survivor_of(ParticleId{99, 1}), std::nullopt);
}

TEST(Survivors, of_more_than_65536_retirements_are_forgotten_oldest_first) {
  Model model;
  const BodyId alive = model.bodies.id(model.make_body(BodyKind::dynamic, 0));
  const auto retired = [](std::uint32_t n) { return BodyId{n + 10, 1}; };
  for (std::uint32_t n = 0; n < 65537; ++n) model.record_survivor(retired(n), alive);
  EXPECT_EQ(model.survivor_of(retired(0)), std::nullopt);
  EXPECT_EQ(model.survivor_of(retired(1)), alive);
  EXPECT_EQ(model.survivor_of(retired(65536)), alive);
}

TEST(Model, hash_tells_models_apart_that_differ_in_the_last_bit) {
  SmallModel a, b;
  a.body({{1, 0, 0}}), b.body({{1, 0, 0}});
  EXPECT_EQ(a.model.hash(), b.model.hash());
  b.model.rings[0].velocity.y = 5e-324;
  EXPECT_NE(a.model.hash(), b.model.hash());
}

}  // namespace
}  // namespace iota::model
