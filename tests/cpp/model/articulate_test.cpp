// SPDX-License-Identifier: Apache-2.0
// Articulates against a search through the whole graph.
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace iota::model {
namespace {

const std::vector<std::string> sound;

TEST(Articulates, that_join_keep_the_slot_of_the_larger_one) {
  SmallModel m;
  const auto small = m.chain(2), large = m.chain(5, {0, 5, 0});
  const std::uint32_t kept = m.model.bodies[large[0]].articulate;
  m.model.articulates[m.model.bodies[small[0]].articulate].velocity_dirty = 1;
  m.model.articulates[m.model.bodies[small[0]].articulate].owed_work = 2, m.model.articulates[kept].owed_work = 3;
  m.hinge(m.particle(small[1], 1), m.particle(large[0], 0));
  for (const std::uint32_t body : small) EXPECT_EQ(m.model.bodies[body].articulate, kept);
  EXPECT_EQ(m.model.articulates[kept].count, 7u);
  EXPECT_TRUE(m.model.articulates[kept].velocity_dirty) << "what was to be projected still is";
  EXPECT_EQ(m.model.articulates[kept].owed_work, 5) << "both have taken it";
  EXPECT_EQ(ingredient::validate(m.model), sound);
}

TEST(Articulates, are_tried_again_after_an_edit_and_not_where_motion_has_changed_a_contact) {
  SmallModel m;
  const std::uint32_t body = m.chain(1)[0];
  Articulate& articulate = m.model.articulates[m.model.bodies[body].articulate];
  articulate.unsolved_steps = 3;
  m.model.mark_rows(body, false);
  EXPECT_EQ(articulate.unsolved_steps, 3u);
  m.model.mark_rows(body, true);
  EXPECT_EQ(articulate.unsolved_steps, 0u);
}

TEST(Articulates, that_are_cut_give_the_smaller_piece_a_new_one) {
  SmallModel m;
  const auto chain = m.chain(7);
  const std::uint32_t old = m.model.bodies[chain[0]].articulate;
  m.leave_ring(m.particle(chain[5], 0));
  EXPECT_TRUE(m.model.split_articulate(chain[4], chain[5]));
  for (int i = 0; i < 7; ++i) EXPECT_EQ(m.model.bodies[chain[i]].articulate == old, i < 5) << i;
  EXPECT_EQ(ingredient::validate(m.model), sound);
}

TEST(Articulates, that_hang_together_otherwise_are_not_split) {
  SmallModel m;
  const std::uint32_t a = m.body({{0, 0, 0}, {1, 0, 0}}), b = m.body({{0, 0, 0}, {1, 0, 0}});
  m.hinge(m.particle(a, 0), m.particle(b, 0));
  EXPECT_FALSE(m.model.split_articulate(a, a));
  EXPECT_FALSE(m.model.split_articulate(a, b));
  ingredient::Closing closing;
  closing.p = m.particle(a, 1), closing.q = m.particle(b, 1), closing.duration = 1;
  ingredient::Closings::add(m.model, closing);
  m.leave_ring(m.particle(b, 0));
  EXPECT_FALSE(m.model.split_articulate(a, b)) << "two bodies on their way to each other are one problem";
  EXPECT_EQ(ingredient::validate(m.model), sound);
}

TEST(Articulates, agree_with_a_search_through_the_graph_after_random_hinges_and_cuts) {
  std::mt19937 random(9);
  const auto below = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int round = 0; round < 20; ++round) {
    SmallModel m;
    std::vector<std::uint32_t> bodies, particles;
    for (int i = 0; i < 20; ++i) {
      bodies.push_back(m.body({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
      for (int n = 0; n < 3; ++n) particles.push_back(m.particle(bodies.back(), n));
    }
    for (int edit = 0; edit < 100; ++edit) {
      const std::uint32_t p = particles[below(particles.size())], q = particles[below(particles.size())];
      const std::uint32_t a = m.model.particles[p].ring, b = m.model.particles[q].ring;
      std::set<std::uint32_t> owners;
      for (const std::uint32_t ring : {a, b})
        m.model.for_each_in_ring(ring, [&](std::uint32_t member) { owners.insert(m.model.particles[member].body); });
      if (below(2) == 0 && a != b && owners.size() == m.model.rings[a].count + m.model.rings[b].count) {
        m.hinge(p, q);
      } else if (m.model.rings[a].count > 1) {
        owners.clear();
        m.model.for_each_in_ring(a, [&](std::uint32_t member) { owners.insert(m.model.particles[member].body); });
        m.leave_ring(p);
        owners.erase(m.model.particles[p].body);
        (void)m.model.split_articulate(m.model.particles[p].body, *owners.begin());
      }
      ASSERT_EQ(ingredient::validate(m.model), sound) << "round " << round << " edit " << edit;
    }
  }
}

TEST(Marked, names_each_articulate_once_and_tells_local_changes_from_others) {
  SmallModel m;
  const auto chain = m.chain(3);
  const std::uint32_t lone = m.body({{0, 9, 0}});
  Model::Marked marked;
  m.model.take_marked(marked);
  EXPECT_FALSE(m.model.is_marked());
  const std::uint32_t of_chain = m.model.bodies[chain[0]].articulate, of_lone = m.model.bodies[lone].articulate;

  m.model.mark_ring(m.model.particles[m.particle(chain[1], 0)].ring);
  m.model.mark_body(lone), m.model.mark_body(lone);
  EXPECT_TRUE(m.model.is_marked());
  m.model.take_marked(marked);
  ASSERT_EQ(marked.articulates, (std::vector{of_chain, of_lone}));
  EXPECT_EQ(marked.only_locally, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(marked.local.bodies, (std::vector{chain[0], chain[1]}));
  ASSERT_EQ(marked.local.rings.size(), 1u);
  EXPECT_EQ(marked.local.rings[0].ring, m.model.particles[m.particle(chain[1], 0)].ring);

  m.model.mark_ring(m.model.particles[m.particle(chain[1], 0)].ring);
  m.model.mark_body(chain[2]);
  m.model.take_marked(marked);
  EXPECT_EQ(marked.only_locally, std::vector<std::uint8_t>{0}) << "something else has changed, too";
}

TEST(TiedBodies, are_those_that_hinges_and_implicit_bonds_connect) {
  SmallModel m;
  const auto left = m.chain(2), right = m.chain(2, {0, 3, 0}), apart = m.chain(1, {0, 6, 0});
  ingredient::Bond bond;
  bond.p = m.particle(left[1], 1), bond.q = m.particle(right[0], 0);
  const std::uint32_t slot = ingredient::Bonds::add(m.model, bond);
  const auto tied = [&](Model::Ties ties) {
    std::vector<std::uint32_t> list = m.model.tied_bodies(std::vector{left[0]}, ties);
    std::sort(list.begin(), list.end());
    return list;
  };
  EXPECT_EQ(tied(Model::Ties::all), (std::vector{left[0], left[1], right[0], right[1]}));
  EXPECT_EQ(tied(Model::Ties::constraints), (std::vector{left[0], left[1]}));
  m.model.bonds[slot].implicit = 0;
  EXPECT_EQ(tied(Model::Ties::all), (std::vector{left[0], left[1]})) << "a force that is held ties nobody";
  (void)apart;
}

}  // namespace
}  // namespace iota::model
