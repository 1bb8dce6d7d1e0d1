// SPDX-License-Identifier: Apache-2.0
// Who belongs to what after an edit, before any physics: the tables of the thesis, 4.1 to 4.3.
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace iota::model {
namespace {

const std::vector<std::string> no_faults;

struct Edited : testing::Test {
  SmallModel m;
  Model& model = m.model;
  RestructureReport report;

  Vec3& velocity(std::uint32_t p) { return model.rings[model.particles[p].ring].velocity; }
  void TearDown() override { EXPECT_EQ(ingredient::validate(model), no_faults); }
};

using RestructureCombine = Edited;
using RestructureSeparate = Edited;
using RestructureDestroy = Edited;
using RestructureClosing = Edited;

TEST_F(RestructureCombine, meets_at_the_mean_by_mass_and_with_the_momentum_of_both) {
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}, 1), 0), q = m.particle(m.body({{4, 0, 0}}, 3), 0);
  velocity(p) = {0, 8, 0}, velocity(q) = {0, 0, 4};
  const Edit edit = combine_particles(model, p, q, report);
  EXPECT_TRUE(edit.moved && edit.velocity_dirty && report.changed);
  EXPECT_EQ(report.closed_distance, 4);
  EXPECT_EQ(model.position(p), (Vec3{3, 0, 0}));
  EXPECT_EQ(velocity(q), (Vec3{0, 2, 3}));
  EXPECT_EQ(model.particles[p].ring, model.particles[q].ring);
  EXPECT_EQ(model.articulates.size(), 1u);
}

TEST_F(RestructureCombine, meets_at_a_nail_or_at_the_immovable_body) {
  for (const bool first : {true, false}) {
    const std::uint32_t loose = m.particle(m.body({{0, 0, 0}}), 0), nailed = m.particle(m.body({{4, 0, 0}}), 0);
    model.rings[model.particles[nailed].ring].nailed = 1;
    model.nails.make(model.particles[nailed].ring).position = {4, 0, 0};
    (void)combine_particles(model, first ? nailed : loose, first ? loose : nailed, report);
    EXPECT_EQ(model.position(loose), (Vec3{4, 0, 0}));
    EXPECT_TRUE(model.rings[model.particles[loose].ring].nailed);
  }
  const std::uint32_t loose = m.particle(m.body({{0, 0, 0}}), 0),
                      wall = m.particle(m.body({{7, 0, 0}}, 1, BodyKind::static_), 0);
  (void)combine_particles(model, loose, wall, report);
  EXPECT_EQ(model.position(loose), (Vec3{7, 0, 0}));
}

TEST_F(RestructureCombine, refuses_impossible_pairs_and_changes_nothing) {
  const std::uint32_t rod = m.body({{0, 0, 0}, {1, 0, 0}}), other = m.body({{0, 0, 0}});
  m.hinge(m.particle(rod, 0), m.particle(other, 0));
  const std::uint32_t left = m.particle(m.body({{0, 5, 0}}, 1, BodyKind::static_), 0),
                      right = m.particle(m.body({{1, 5, 0}}, 1, BodyKind::static_), 0);
  const std::uint64_t hash = model.hash();
  EXPECT_THROW((void)combine_particles(model, m.particle(other, 0), m.particle(rod, 1), report), std::invalid_argument)
      << "two particles of the rod would be in one place";
  EXPECT_THROW((void)combine_particles(model, left, right, report), std::invalid_argument)
      << "neither of two static bodies gives way";
  EXPECT_EQ(model.hash(), hash);
}

TEST_F(RestructureCombine, of_a_hinge_makes_one_rigid_body_that_remembers_its_parts) {
  const auto chain = m.chain(2);
  const BodyId first = model.bodies.id(chain[0]), second = model.bodies.id(chain[1]);
  const ParticleId absorbed = model.particles.id(m.particle(chain[1], 0));
  (void)combine_particles(model, m.particle(chain[0], 1), m.particle(chain[1], 0), report);
  EXPECT_EQ(model.bodies.size(), 1u);
  EXPECT_EQ(model.bodies[chain[0]].count, 3u);
  EXPECT_EQ(model.survivor_of(second), first);
  EXPECT_EQ(model.survivor_of(absorbed), model.particles.id(m.particle(chain[0], 1)));
  EXPECT_EQ(model.particles[m.particle(chain[0], 1)].mass, 2) << "of both";
  EXPECT_EQ(parts_of(model, chain[0]), (std::vector{first, second}));

  RestructureReport back;
  (void)separate_part(model, chain[0], second, back);
  ASSERT_EQ(back.created_bodies.size(), 1u);
  ASSERT_EQ(back.created_particles.size(), 1u) << "the hinge is one again";
  const std::uint32_t own = back.created_bodies[0].slot;
  EXPECT_EQ(model.bodies[own].count, 2u);
  EXPECT_EQ(model.body_mass(own), 2);
  EXPECT_EQ(model.bodies[own].articulate, model.bodies[chain[0]].articulate);
}

TEST_F(RestructureSeparate, of_one_particle_makes_two_of_half_the_mass) {
  const std::uint32_t body = m.body({{1, 2, 3}}, 5), p = m.particle(body, 0);
  (void)separate_particles(model, p, p, report);
  ASSERT_EQ(report.created_particles.size(), 1u);
  const std::uint32_t twin = report.created_particles[0].slot;
  EXPECT_EQ(model.particles[p].mass, 2.5);
  EXPECT_EQ(model.particles[twin].mass, 2.5);
  EXPECT_EQ(model.position(twin), (Vec3{1, 2, 3}));
  EXPECT_NE(model.particles[p].ring, model.particles[twin].ring);
}

TEST_F(RestructureSeparate, within_a_body_hinges_the_latter_to_the_former) {
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::uint32_t p = m.particle(body, 0), q = m.particle(body, 1);
  (void)separate_particles(model, p, q, report);
  ASSERT_EQ(report.created_bodies.size(), 1u);
  EXPECT_EQ(model.particles[q].body, report.created_bodies[0].slot);
  EXPECT_EQ(model.particles[p].ring, model.particles[q].ring);
  EXPECT_EQ(model.bodies[body].count, 2u);
  EXPECT_EQ(model.articulates.size(), 1u);
}

TEST_F(RestructureSeparate, at_a_hinge_takes_the_latter_out_of_the_ring_in_place) {
  const auto chain = m.chain(3);
  const std::uint32_t p = m.particle(chain[0], 1), q = m.particle(chain[1], 0);
  velocity(p) = {1, 2, 3};
  (void)separate_particles(model, p, q, report);
  EXPECT_NE(model.particles[p].ring, model.particles[q].ring);
  EXPECT_EQ(model.position(p), model.position(q));
  EXPECT_EQ(velocity(q), (Vec3{1, 2, 3}));
  EXPECT_EQ(model.articulates.size(), 2u);
  const bool changed = report.changed;
  EXPECT_TRUE(changed);
  RestructureReport nothing;
  (void)separate_particles(model, p, q, nothing);
  EXPECT_FALSE(nothing.changed) << "they are unrelated now";
}

TEST_F(RestructureClosing, ends_without_a_trace_when_it_is_called_off) {
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0), q = m.particle(m.body({{1, 0, 0}}), 0);
  ingredient::Closing closing;
  closing.p = p, closing.q = q, closing.duration = 1;
  model.join_articulates(model.bodies[model.particles[p].body].articulate,
                         model.bodies[model.particles[q].body].articulate);
  const std::uint32_t slot = ingredient::Closings::add(model, closing);
  EXPECT_EQ(ingredient::validate(model), no_faults);
  EXPECT_EQ(ingredient::Closings::between(model, p, q), slot);
  EXPECT_EQ(ingredient::Closings::between(model, q, p), slot);
  ingredient::Closings::end(model, slot);
  EXPECT_EQ(ingredient::Closings::between(model, p, q), none);
  EXPECT_EQ(model.articulates.size(), 2u);
  EXPECT_EQ(model.particles[p].uses + model.particles[q].uses, 0u);
}

TEST_F(RestructureDestroy, a_body_takes_its_bonds_and_hinges_with_it) {
  const auto chain = m.chain(3);
  ingredient::Bond bond;
  bond.p = m.particle(chain[1], 1), bond.q = m.particle(chain[2], 1);
  ingredient::Bonds::add(model, bond);
  destroy_body(model, chain[1]);
  EXPECT_EQ(model.bonds.size(), 0u);
  EXPECT_EQ(model.articulates.size(), 2u);
  EXPECT_EQ(model.rings.size(), 4u);
}

TEST_F(RestructureDestroy, the_last_massive_particle_takes_its_body_along) {
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}});
  model.make_marker(body, {0.5, 0, 0});
  destroy_particle(model, m.particle(body, 0));
  EXPECT_TRUE(model.bodies.is_alive(body));
  EXPECT_EQ(model.bodies[body].count, 1u) << "a point does not carry a marker that is elsewhere";
  destroy_particle(model, m.particle(body, 0));
  EXPECT_FALSE(model.bodies.is_alive(body));
  EXPECT_EQ(model.particles.size(), 0u);
}

}  // namespace
}  // namespace iota::model
