// SPDX-License-Identifier: Apache-2.0
#include "solver/loops.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <vector>

namespace iota::solver {
namespace {

constexpr std::uint8_t joints = 1;

/// So many points with all lengths between them.
std::vector<std::uint32_t> add_body(Problem& problem, int count) {
  std::vector<std::uint32_t> nodes;
  for (int k = 0; k < count; ++k) {
    nodes.push_back(add_point(problem, {0.3 * k, 0.1 * k * k, k == 3 ? 1.0 : 0.0}));
    for (int other = 0; other < k; ++other)
      (void)add_rod(problem, nodes[static_cast<std::size_t>(other)], nodes.back(), 1);
  }
  return nodes;
}

/// Holds two points at one place by three rows; with one point, at its own place.
void hold(Problem& problem, const std::vector<std::uint32_t>& points, std::uint32_t slot) {
  for (const Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    BilinearConstraint row;
    for (std::size_t k = 0; k < points.size(); ++k) (void)row.add(0, points[k], k == 0 ? 1 : -1);
    row.set_constant(1, axis);
    problem.add(row, {joints, {}, slot});
  }
}

TEST(Loops, are_in_no_chain_and_in_no_body) {
  Problem problem;
  std::uint32_t before = add_point(problem, {});
  for (int k = 1; k < 5; ++k) {
    const std::uint32_t next = add_point(problem, {1.0 * k, 0, 0});
    (void)add_rod(problem, before, next, 1);
    before = next;
  }
  for (const int count : {2, 3, 4}) (void)add_body(problem, count);
  EXPECT_FALSE(has_loops(problem));
}

TEST(Loops, are_in_a_square_and_in_a_body_of_five_points) {
  for (const int points : {4, 5}) {
    Problem problem;
    if (points == 5) {
      (void)add_body(problem, 5);
    } else {
      for (int k = 0; k < 4; ++k) (void)add_point(problem, {1.0 * k, 0, 0});
      for (std::uint32_t k = 0; k < 4; ++k) (void)add_rod(problem, k, (k + 1) % 4, 1);
    }
    EXPECT_TRUE(has_loops(problem)) << points;
  }
}

TEST(Loops, are_closed_by_the_second_joint_of_two_bodies) {
  Problem problem;
  const std::vector<std::uint32_t> first = add_body(problem, 4), second = add_body(problem, 4);
  hold(problem, {first[0], second[0]}, 0);
  EXPECT_FALSE(has_loops(problem)) << "one joint has several rows";
  hold(problem, {first[1], second[1]}, 1);
  EXPECT_TRUE(has_loops(problem));
}

TEST(Loops, are_closed_by_the_world) {
  Problem problem;
  const std::vector<std::uint32_t> first = add_body(problem, 4), second = add_body(problem, 4);
  hold(problem, {first[0], second[0]}, 0);
  hold(problem, {first[1]}, 1);
  EXPECT_FALSE(has_loops(problem));
  hold(problem, {second[1]}, 2);
  EXPECT_TRUE(has_loops(problem));
}

}  // namespace
}  // namespace iota::solver
