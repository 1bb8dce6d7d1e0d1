// SPDX-License-Identifier: Apache-2.0
// Part of a problem is projected as the whole of it would be.
#include "solver/integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace iota::solver {
namespace {

constexpr std::uint32_t size = 3000, middle = 1700;

/// A zigzag of points, each a unit length from the next; its first one is nailed where asked to.
Problem make_zigzag(bool nailed, double width = 0.6) {
  Problem problem;
  problem.add_nodes(size);
  for (std::uint32_t i = 0; i < size; ++i) {
    problem.add_mass(i, 1 + 0.3 * (i % 4));
    problem.position[i] = {std::sqrt(1 - width * width) * i, width * (i % 2), 0};
  }
  for (std::uint32_t i = 0; i + 1 < size; ++i) problem.add(DistanceConstraint{{i, i + 1}, 1, 1}, {1, {}, i});
  if (nailed) {
    AffineConstraint nail;
    nail.weights[0] = 1, nail.count = 1, nail.target = nail.target_start = problem.position[0];
    problem.add(nail, {2, {}, 0});
  }
  return problem;
}

/// Moves a point a little, as a hinge does that is closed, and gives it and its neighbors other velocities.
void disturb(Problem& problem, double by) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  problem.position[middle] += by * Vec3{any(random), any(random), any(random)};
  for (std::uint32_t i = middle - 1; i <= middle + 1; ++i)
    problem.velocity[i] += Vec3{any(random), any(random), any(random)};
}

bool project_around_middle(Problem& problem) {
  Integrator integrator;
  integrator.compile(problem);
  return integrator.project_locally(problem, true, std::vector<std::uint32_t>{middle});
}

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
  return most;
}

TEST(LocalProjection, equals_the_projection_of_the_whole_problem) {
  for (const bool nailed : {false, true})
    for (const double by : {1e-6, 1e-3, 0.05}) {
      Problem local = make_zigzag(nailed), whole = make_zigzag(nailed);
      disturb(local, by), disturb(whole, by);
      Integrator part_of, all_of;
      part_of.compile(local), all_of.compile(whole);
      const std::vector<std::uint32_t> center{middle - 1, middle, middle + 1};
      ASSERT_TRUE(part_of.project_locally(local, true, center));
      ASSERT_TRUE(all_of.project_positions(whole));
      all_of.project_velocities(whole);
      EXPECT_LT(part_of.moved_locally().size(), size / 8);
      // Both meet their rows to 1e-9 of a length only.
      EXPECT_LT(farthest(local.position, whole.position), 1e-8) << "moved by " << by;
      EXPECT_LT(farthest(local.velocity, whole.velocity), 1e-7) << "moved by " << by;
      EXPECT_LT(local.worst_gap(local.position.data()), 1e-9);
    }
}

TEST(LocalProjection, keeps_momentum_and_whatever_is_further_away) {
  Problem problem = make_zigzag(false);
  for (Vec3& v : problem.velocity) v = {1, 2, 3};
  disturb(problem, 1e-3);
  const Problem before = problem;
  ASSERT_TRUE(project_around_middle(problem));
  Vec3 change;
  for (std::uint32_t i = 0; i < size; ++i) change += problem.mass[i] * (problem.velocity[i] - before.velocity[i]);
  EXPECT_LT(norm(change), 1e-11);
  for (const std::uint32_t far : {0u, middle - 400, middle + 400, size - 1}) {
    EXPECT_EQ(problem.position[far], before.position[far]);
    EXPECT_EQ(problem.velocity[far], before.velocity[far]);
  }
}

TEST(LocalProjection, leaves_far_reaching_changes_to_the_whole_problem) {
  Problem problem = make_zigzag(true, 0.01);  // almost straight: a pull along it goes on for hundreds of links
  disturb(problem, 1e-4);
  const Problem before = problem;
  EXPECT_FALSE(project_around_middle(problem));
  EXPECT_EQ(farthest(problem.position, before.position), 0);
  EXPECT_EQ(farthest(problem.velocity, before.velocity), 0);
}

TEST(LocalProjection, does_small_problems_whole) {
  Problem problem;
  problem.add_nodes(2);
  problem.add_mass(0, 1), problem.add_mass(1, 1);
  problem.position[1] = {2, 0, 0};
  problem.add(DistanceConstraint{{0, 1}, 1, 1}, {});
  Integrator integrator;
  integrator.compile(problem);
  EXPECT_FALSE(integrator.project_locally(problem, true, std::vector<std::uint32_t>{0}));
}

}  // namespace
}  // namespace iota::solver
