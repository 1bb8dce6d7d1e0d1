// SPDX-License-Identifier: Apache-2.0
#include "ingredient/cosmetic_bonds.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace iota {
namespace {

/// A body of four particles on a square that turns about z; bonds are given by their ends.
struct Square {
  System system{SystemOptions{.gravity = {}}};
  BodyId body = system.bodies().create();
  std::vector<ParticleId> corners;
  std::vector<CosmeticBondId> bonds;

  explicit Square(const std::vector<std::array<int, 2>>& ends) {
    for (const Vec3& x : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}})
      corners.push_back(system.particles().create(body, x, 1, {-x.y, x.x, 0}));
    for (const auto& [p, q] : ends)
      bonds.push_back(
          system.cosmetic_bonds().create(corners[static_cast<std::size_t>(p)], corners[static_cast<std::size_t>(q)]));
  }
  BodyId body_of(int corner) { return system.particles().body(corners[static_cast<std::size_t>(corner)]); }
};

TEST(CosmeticBonds, hold_a_body_together_while_another_way_is_left) {
  Square ring({{0, 1}, {1, 2}, {2, 3}, {3, 0}});
  EXPECT_TRUE(ring.system.cosmetic_bonds().destroy(ring.bonds[1]).created_bodies.empty());
  EXPECT_EQ(ring.body_of(1), ring.body_of(2));
  const RestructureReport report = ring.system.cosmetic_bonds().destroy(ring.bonds[3]);
  EXPECT_EQ(report.created_bodies.size(), 1u);
  EXPECT_EQ(ring.body_of(0), ring.body_of(1));
  EXPECT_EQ(ring.body_of(2), ring.body_of(3));
  EXPECT_NE(ring.body_of(1), ring.body_of(2));
}

TEST(CosmeticBonds, that_are_cut_leave_the_velocities_of_the_pieces) {
  Square line({{0, 1}, {1, 2}, {2, 3}});
  const Vec3 angular = line.system.angular_momentum();
  const RestructureReport report = line.system.cosmetic_bonds().destroy(line.bonds[1]);
  EXPECT_LT(norm(report.momentum_change) + norm(report.angular_momentum_change), 1e-14);
  EXPECT_LT(norm(line.system.angular_momentum() - angular), 1e-14);
  for (int i = 0; i < 100; ++i) (void)line.system.step(0.01);
  EXPECT_LT(norm(line.system.angular_momentum() - angular), 1e-9);
  // Each half turns on by 1 rad/s and its center, at 1/sqrt 2 from the middle, flies straight on at 1/sqrt 2 m/s.
  EXPECT_NEAR(norm(line.system.bodies().center_of_mass(line.body_of(0))), 1, 1e-6);
  EXPECT_NEAR(line.system.bodies().angular_velocity(line.body_of(0)).z, 1, 1e-6);
}

TEST(CosmeticBonds, move_with_the_absorbing_particle_and_end_with_a_destroyed_one) {
  Square line({{0, 1}, {1, 2}});
  (void)line.system.edits().combine(line.corners[3], line.corners[2]);  // of one body: the latter is removed
  EXPECT_EQ(line.system.cosmetic_bonds().ends(line.bonds[1]), (std::pair{line.corners[1], line.corners[3]}));
  line.system.particles().destroy(line.corners[0]);
  EXPECT_FALSE(line.system.cosmetic_bonds().contains(line.bonds[0]));
  EXPECT_TRUE(line.system.cosmetic_bonds().contains(line.bonds[1]));
  EXPECT_EQ(line.system.validate(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iota
