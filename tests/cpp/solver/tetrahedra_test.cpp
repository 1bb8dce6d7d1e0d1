// SPDX-License-Identifier: Apache-2.0
#include "solver/tetrahedra.h"
#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace iota::solver {
namespace {

/// The corners of a plate 1 m wide, of this thickness, and a rod at one of them.
Problem plate(double thickness) {
  Problem problem;
  for (const Vec3& place : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}, Vec3{0.4, thickness, 0.4}, Vec3{2, 0, 0}})
    (void)add_point(problem, place, 1);
  const auto hold = [&](std::uint32_t a, std::uint32_t b) {
    (void)add_rod(problem, a, b, norm(problem.position[b] - problem.position[a]));
  };
  hold(3, 0), hold(0, 1), hold(2, 0), hold(1, 2), hold(3, 1), hold(2, 3);
  hold(1, 4);
  return problem;
}

TEST(Tetrahedra, are_four_points_with_six_rows) {
  const Problem problem = plate(0.1);
  Tetrahedra found;
  found.find(problem);
  EXPECT_EQ(found.size(), 1);
}

TEST(Tetrahedra, have_two_nailed_points_without_a_row_between_them) {
  Problem problem;
  for (const Vec3& place : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}, Vec3{0.4, 0.1, 0.4}})
    (void)add_point(problem, place, 1);
  for (const auto& [a, b] : {std::pair{0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}})
    (void)add_rod(problem, a, b, norm(problem.position[b] - problem.position[a]));
  Tetrahedra found;
  found.find(problem);
  EXPECT_EQ(found.size(), 0);
  nail(problem, 0), nail(problem, 1);
  found.find(problem);
  EXPECT_EQ(found.size(), 1);
}

TEST(Tetrahedra, turn_without_being_mirrored_and_are_mirrored_through_their_base) {
  for (const double thickness : {1.0, 0.1, 1e-3}) {
    const Problem problem = plate(thickness);
    Tetrahedra found;
    found.find(problem);
    std::vector<Vec3> turned, mirrored;
    for (const Vec3& x : problem.position) turned.push_back({-x.x, -x.y, x.z}), mirrored.push_back({x.x, -x.y, x.z});
    EXPECT_FALSE(found.are_mirrored(problem.position, turned)) << thickness;
    EXPECT_TRUE(found.are_mirrored(problem.position, mirrored)) << thickness;
  }
}

TEST(Tetrahedra, that_are_flat_have_no_side) {
  const Problem problem = plate(1e-8);
  Tetrahedra found;
  found.find(problem);
  std::vector<Vec3> other;
  for (const Vec3& x : problem.position) other.push_back({x.x, -x.y, x.z});
  EXPECT_FALSE(found.are_mirrored(problem.position, other));
}

}  // namespace
}  // namespace iota::solver
