// SPDX-License-Identifier: Apache-2.0
#include "solver/problem.h"

#include "tests/cpp/solver/small_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace iota::solver {
namespace {

// A gap that is not a number would otherwise look like no gap: a projection that has failed was taken for one that has
// closed everything.
TEST(Problem, a_gap_that_is_not_a_number_is_the_largest) {
  Problem problem = zigzag(3);
  ASSERT_LT(problem.worst_gap(problem.position.data()), 1e-12);
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    const Vec3 place = problem.position[node];
    problem.position[node].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(problem.worst_gap(problem.position.data()))) << "node " << node;
    EXPECT_TRUE(std::isinf(problem.worst_gap(problem.position.data(), 0, true))) << "node " << node;
    problem.position[node] = place;
  }
}

TEST(Problem, folds_visit_only_pools_that_were_used_in_the_order_of_the_lists_whatever_came_first) {
  Problem problem;
  const auto count_pools = [&] {
    int count = 0;
    problem.for_each_constraint_pool([&](const auto&) { ++count; });
    problem.for_each_force_pool([&](const auto&) { ++count; });
    return count;
  };
  EXPECT_EQ(count_pools(), 0);
  EXPECT_FALSE(problem.has_used_constraints());
  const std::uint32_t a = add_point(problem, {}), b = add_point(problem, {1, 0, 0});
  add_spring(problem, a, b, 1, 1);
  EXPECT_EQ(count_pools(), 1);
  EXPECT_FALSE(problem.has_used_constraints());
  const ItemKey of_row{1, {}, 7}, of_nail{2, {}, 8};
  problem.add(distance(a, b, 1), of_row);
  problem.add(AffineConstraint{.nodes = {a}, .weights = {1}, .count = 1}, of_nail);
  EXPECT_EQ(count_pools(), 3);
  EXPECT_EQ(problem.key_of(0, 0), of_nail) << "nails come first in the list";
  EXPECT_EQ(problem.key_of(1, 0), of_row);
  EXPECT_EQ(problem.items_of<AffineConstraint>().size(), 1u);
  EXPECT_EQ(problem.items_of<SpringForce>().size(), 1u);
  EXPECT_TRUE(problem.items_of<AngleConstraint>().empty());
  EXPECT_TRUE(problem.items_of<GripForce>().empty());
}

/// Two points and a rod, maybe with a nail and coupled masses.
void build(Problem& problem, double mass, bool is_nailed = false, bool is_coupled = false) {
  problem.add_nodes(2);
  for (const std::uint32_t node : {0u, 1u}) problem.add_mass(node, mass);
  if (is_coupled) problem.couple_masses(0, 1, 0.1 * mass);
  problem.add(DistanceConstraint{{0, 1}, mass, mass}, {});
  if (is_nailed) problem.add(AffineConstraint{.nodes = {0}, .weights = {1}, .count = 1}, {});
}

TEST(Problem, has_the_structure_of_one_that_differs_in_numbers_alone) {
  Problem problem;
  build(problem, 1);
  const std::uint64_t structure = problem.structure();
  EXPECT_NE(structure, 0u);
  problem.note_compiled();
  EXPECT_EQ(problem.structure(), 0u) << "not known: its owner may have changed its lists since then";
  const auto again = [&](double mass, bool is_nailed, bool is_coupled) {
    problem.clear();
    build(problem, mass, is_nailed, is_coupled);
    return problem.structure();
  };
  EXPECT_EQ(again(2, false, false), structure);
  EXPECT_NE(again(1, true, false), structure);
  EXPECT_NE(again(1, false, true), structure);
  problem.clear();
  problem.add_nodes(2);
  problem.add(DistanceConstraint{{1, 0}, 1, 1}, {});
  EXPECT_NE(problem.structure(), structure);
}

TEST(Problem, copies_have_pools_of_their_own) {
  Problem problem;
  build(problem, 1);
  Problem copy = problem;
  copy.pool_of<DistanceConstraint>().items[0].length = 5;
  EXPECT_EQ(problem.items_of<DistanceConstraint>()[0].length, 1);
  problem = copy;
  EXPECT_EQ(problem.items_of<DistanceConstraint>()[0].length, 5);
}

}  // namespace
}  // namespace iota::solver
