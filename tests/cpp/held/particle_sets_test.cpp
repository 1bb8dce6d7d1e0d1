// SPDX-License-Identifier: Apache-2.0
#include "held/particle_sets.h"

#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <vector>

namespace iota::held {
namespace {

using Slots = std::vector<std::uint32_t>;

/// Two rods of 1 kg a particle, hinged at (1, 0, 0), and a static body at (5, 0, 0).
struct HingedRods {
  model::SmallModel small;
  Slots rods = small.chain(2);
  std::uint32_t rock = small.body({{5, 0, 0}}, 7, BodyKind::static_);
  Parallel parallel;

  std::uint32_t first = small.particle(rods[0], 0), hinge = small.particle(rods[0], 1),
                other_side = small.particle(rods[1], 0), last = small.particle(rods[1], 1);
  std::uint32_t ring(std::uint32_t p) const { return small.model.particles[p].ring; }
};

TEST(ParticleSet, has_hinged_particles_as_one_row_with_their_total_mass) {
  HingedRods s;
  ParticleSet all;
  all.find(s.small.model);
  EXPECT_EQ(all.rings, (Slots{s.ring(s.first), s.ring(s.hinge), s.ring(s.last), s.ring(s.small.particle(s.rock, 0))}));
  all.load(s.small.model, 0, 0, s.parallel);
  EXPECT_EQ(all.arrays.m, (std::vector<double>{1, 2, 1, 7}));
  EXPECT_EQ(all.arrays.x, (std::vector<double>{0, 1, 2, 5}));
  EXPECT_EQ(all.is_pushed, (std::vector<std::uint8_t>{1, 1, 1, 0}));
}

TEST(ParticleSet, is_loaded_where_its_particles_will_be) {
  HingedRods s;
  ParticleSet all;
  all.find(s.small.model);
  s.small.model.rings[s.ring(s.last)].velocity = {1, 2, 3};
  all.load(s.small.model, 0.5, 0, s.parallel);
  EXPECT_EQ(all.arrays.x[2], 2.5);
  EXPECT_EQ(all.arrays.y[2], 1);
  EXPECT_EQ(all.arrays.vz[2], 3);
  all.follow(s.small.model);
  EXPECT_EQ(all.arrays.x[2], 2) << "the present place";
}

TEST(ParticleSet, of_two_groups_knows_the_sides_of_each_row) {
  HingedRods s;
  s.small.model.particles[s.first].groups = 1u << 3;
  s.small.model.particles[s.other_side].groups = 1u << 3 | 1u << 4;  // the ring is in, by either of its particles
  s.small.model.particles[s.last].groups = 1u << 4;
  ParticleSet set;
  set.group = 3, set.other = 4;
  set.find(s.small.model);
  EXPECT_EQ(set.rings, (Slots{s.ring(s.first), s.ring(s.hinge), s.ring(s.last)}));
  EXPECT_EQ(set.sides, (std::vector<std::uint8_t>{1, 3, 2}));
  set = {}, set.group = 3;
  set.find(s.small.model);
  EXPECT_EQ(set.rings, (Slots{s.ring(s.first), s.ring(s.hinge)}));
}

TEST(ParticleSet, adds_its_forces_to_those_on_movable_particles) {
  HingedRods s;
  ParticleSet all;
  all.find(s.small.model);
  all.load(s.small.model, 0, 0, s.parallel);
  s.small.model.pushes.make(s.ring(s.last)).force = {0, 0, 9};
  for (std::size_t i = 0; i < 4; ++i) all.arrays.fx[i] = 1.0 + static_cast<double>(i);
  all.unload(s.small.model, s.parallel);
  EXPECT_EQ(s.small.model.pushes[s.ring(s.hinge)].force, (Vec3{2, 0, 0}));
  EXPECT_EQ(s.small.model.pushes[s.ring(s.last)].force, (Vec3{3, 0, 9}));
  EXPECT_FALSE(s.small.model.pushes.has(s.ring(s.small.particle(s.rock, 0))));
}

TEST(ParticleSets, are_found_once_until_structure_or_members_change) {
  HingedRods s;
  ParticleSets sets;
  sets.update(s.small.model);
  const ParticleSet* const all = &sets.of(s.small.model, model::none);
  EXPECT_EQ(&sets.of(s.small.model, model::none), all);
  EXPECT_NE(&sets.of(s.small.model, 3), all);
  sets.update(s.small.model);
  EXPECT_EQ(sets.sets.size(), 2u);
  ++s.small.model.members_revision;
  sets.update(s.small.model);
  EXPECT_TRUE(sets.sets.empty());
  (void)sets.of(s.small.model, model::none);
  ++s.small.model.structure_version;
  sets.update(s.small.model);
  EXPECT_TRUE(sets.sets.empty());
}

}  // namespace
}  // namespace iota::held
