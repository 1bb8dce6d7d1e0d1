// SPDX-License-Identifier: Apache-2.0
#include "solver/rigid_modes.h"

#include "solver/pieces.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <vector>

namespace iota::solver {
namespace {

Vec3 corner(double size) { return size * Vec3{3, 1, -2}; }

/// A tetrahedron of rods with edges of a length, away from the origin.
Problem tetrahedron(double size) {
  Problem problem;
  for (const Vec3& place : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    (void)add_point(problem, corner(size) + size * place);
  for (std::uint32_t b = 1; b < 4; ++b)
    for (std::uint32_t a = 0; a < b; ++a) (void)add_rod(problem, a, b, norm(problem.position[a] - problem.position[b]));
  return problem;
}
RigidModes noticed_by_world(const Problem& problem, double size) {
  const std::vector<std::uint32_t> part_of(problem.size(), 0);
  RigidModes noticed{.center = corner(size), .length = size};
  add_noticed_modes(problem, part_of, {&noticed, 1});
  return noticed;
}

class RigidModesOfSize : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Decades, RigidModesOfSize, testing::Values(1e-6, 1e-3, 1.0, 1e3));

TEST_P(RigidModesOfSize, of_a_free_body_are_noticed_by_nothing) {
  const double size = GetParam();
  const RigidModes noticed = noticed_by_world(tetrahedron(size), size);
  EXPECT_EQ(noticed.count, 0);
  EXPECT_FALSE(noticed.axle());
}

TEST_P(RigidModesOfSize, but_the_turning_about_the_line_of_two_nails_are_noticed) {
  const double size = GetParam();
  Problem problem = tetrahedron(size);
  nail(problem, 1);
  EXPECT_EQ(noticed_by_world(problem, size).count, 3);
  EXPECT_FALSE(noticed_by_world(problem, size).axle());
  nail(problem, 2);
  const std::optional<Axle> axle = noticed_by_world(problem, size).axle();
  ASSERT_TRUE(axle);
  const Vec3 along = (1 / std::sqrt(2)) * Vec3{1, -1, 0};
  EXPECT_LT(norm(cross(axle->direction, along)), 1e-12);
  EXPECT_LT(norm(cross(axle->place - problem.position[1], along)), 1e-12 * size);
  nail(problem, 3);
  EXPECT_TRUE(noticed_by_world(problem, size).are_all());
}

TEST_P(RigidModesOfSize, of_a_body_that_only_slides_have_no_axle) {
  const double size = GetParam();
  Problem problem = tetrahedron(size);
  nail(problem, 1), nail(problem, 2), nail(problem, 3);
  RigidModes all = noticed_by_world(problem, size), slides{.center = corner(size), .length = size};
  ASSERT_TRUE(all.are_all());
  for (const RigidMode& mode : {RigidMode{{1, 0, 0}, {}}, RigidMode{{0, 1, 0}, {}}, RigidMode{{}, {1, 0, 0}},
                                RigidMode{{}, {0, 1, 0}}, RigidMode{{}, {0, 0, 1}}})
    slides.add(mode, 1);
  EXPECT_EQ(slides.count, 5);
  EXPECT_FALSE(slides.axle());
}

TEST(RigidModes, of_parts_are_apart_and_those_on_points_of_no_part_are_noticed) {
  Problem problem = tetrahedron(1);
  const std::uint32_t fixed = add_point(problem, corner(1) + Vec3{1, 1, 1}), free = add_point(problem, {});
  (void)add_rod(problem, 1, fixed, std::sqrt(2));
  nail(problem, free);
  std::vector<std::uint32_t> part_of(problem.size(), 0);
  part_of[fixed] = Pieces::none, part_of[free] = 1;
  std::vector<RigidModes> noticed(2, RigidModes{.center = corner(1)});
  add_noticed_modes(problem, part_of, noticed);
  EXPECT_EQ(noticed[0].count, 1);  // the rod
  EXPECT_EQ(noticed[1].count, 3);  // the nail
}

}  // namespace
}  // namespace iota::solver
