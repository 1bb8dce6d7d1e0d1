// SPDX-License-Identifier: Apache-2.0
#include "ingredient/island_nodes.h"

#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace iota::ingredient {
namespace {

using Slots = std::vector<std::uint32_t>;

/// A body of four basis points and two particles that they carry, hinged by a corner to a rod.
struct CarriedParticles {
  model::SmallModel small;
  std::uint32_t rod = small.body({{1, 0, 0}, {2, 0, 0}});
  std::uint32_t body = small.body({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.3, 0.1}, {0.5, 0.5, 0.5}});
  IslandNodes nodes;
  Slots node_of_ring;

  CarriedParticles() {
    small.hinge(small.particle(rod, 0), small.particle(body, 1));
    node_of_ring.assign(small.model.rings.slot_count(), none);
    nodes.build(small.model, Slots{small.model.bodies[body].articulate}, node_of_ring);
  }
  /// Where the nodes carry the i-th carried particle.
  Vec3 place(std::size_t i) const {
    Vec3 sum;
    for (const auto& [node, weight] : nodes.carriers[i])
      if (weight != 0) sum += weight * small.model.rings[nodes.rings.at(node)].position;
    return sum;
  }
};

TEST(IslandNodes, are_the_points_that_are_unknown_each_ring_once_and_carry_the_others) {
  CarriedParticles c;
  EXPECT_EQ(c.nodes.size(), 5u) << "four corners and the far end of the rod; the hinge is one of these";
  for (std::uint32_t node = 0; node < c.nodes.size(); ++node) EXPECT_EQ(c.node_of_ring[c.nodes.rings[node]], node);
  ASSERT_EQ(c.nodes.carried.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(norm(c.place(i) - c.small.model.position(c.nodes.carried[i])), 1e-15);
  EXPECT_EQ(c.nodes.pinned_count(), 0u);
}

TEST(IslandNodes, leave_out_inactive_particles_and_know_pinned_ones) {
  model::SmallModel small;
  const Slots rods = small.chain(3);
  small.model.bodies[rods[0]].kind = BodyKind::static_;
  small.model.bodies[rods[2]].kind = BodyKind::inactive;
  Slots node_of_ring(small.model.rings.slot_count(), none);
  IslandNodes nodes;
  nodes.build(small.model, Slots{small.model.bodies[rods[0]].articulate}, node_of_ring);
  EXPECT_EQ(nodes.bodies, (Slots{rods[0], rods[1]}));
  EXPECT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes.pinned_count(), 2u) << "both ends of the static rod";
  const std::uint32_t far = node_of_ring[small.model.particles[small.particle(rods[1], 1)].ring];
  EXPECT_FALSE(nodes.pinned[far]);
}

TEST(IslandNodes, keep_carrying_when_a_node_is_removed) {
  for (std::uint32_t removed = 0; removed < 5; ++removed) {
    CarriedParticles c;
    const Slots rings = c.nodes.rings;
    std::vector<Vec3> before{c.place(0), c.place(1)};
    const auto carries = [&](std::size_t i, std::uint32_t node) {
      return std::ranges::any_of(c.nodes.carriers[i], [&](auto& of) { return of.second != 0 && of.first == node; });
    };
    const bool was_used[] = {carries(0, removed), carries(1, removed)};
    ASSERT_TRUE(carries(0, 4)) << "the last node, which takes the number of the removed one";
    c.nodes.remove(Slots{removed});
    ASSERT_EQ(c.nodes.size(), 4u);
    if (removed < 4) EXPECT_EQ(c.nodes.rings[removed], rings[4]) << "the last node takes its number";
    for (std::size_t i = 0; i < 2; ++i)
      if (!was_used[i]) EXPECT_LT(norm(c.place(i) - before[i]), 1e-15);
  }
}

TEST(IslandNodes, find_the_carried_particles_of_a_changed_body_again) {
  CarriedParticles c;
  // A bond makes the first of them an unknown of its own.
  const std::uint32_t inner = c.nodes.carried[0], other = c.nodes.carried[1];
  ++c.small.model.particles[inner].uses;
  c.nodes.find_carried_again(c.small.model, Slots{c.body}, {}, c.node_of_ring);
  EXPECT_EQ(c.nodes.carried, Slots{other});
  --c.small.model.particles[inner].uses;
  c.nodes.find_carried_again(c.small.model, Slots{c.body}, {}, c.node_of_ring);
  EXPECT_EQ(c.nodes.carried, (Slots{inner, other}));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(norm(c.place(i) - c.small.model.position(c.nodes.carried[i])), 1e-15);
}

}  // namespace
}  // namespace iota::ingredient
