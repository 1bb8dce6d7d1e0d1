// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_points.h"

#include "solver/heap.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace iota::solver {
namespace {

constexpr std::uint32_t bodies_of_column = 3;

/// Tetrahedra above each other and above the ground. Corners meet corners, at random places with random friction.
void add_column(Problem& problem, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  const auto at_random = [&](double size) { return size * Vec3{u(random) - 0.5, u(random) - 0.5, u(random) - 0.5}; };
  const auto first = static_cast<std::uint32_t>(problem.size());
  problem.add_nodes(4 * bodies_of_column);
  for (std::uint32_t body = 0; body < bodies_of_column; ++body) {
    const std::uint32_t start = first + 4 * body;
    const std::array<Vec3, 4> corners{{{0, 0, 0}, {1, 0.1, 0}, {0, 0.1, 1}, {0.3, 1, 0.3}}};
    for (std::uint32_t a = 0; a < 4; ++a) {
      problem.position[start + a] = corners[a] + Vec3{0, 1.05 * body + 0.01, 0} + at_random(0.1);
      problem.velocity[start + a] = {0.1 * body, -1, 0.3};
      problem.add_mass(start + a, 0.5 + u(random));
    }
    for (std::uint32_t a = 0; a < 4; ++a)
      for (std::uint32_t b = a + 1; b < 4; ++b) {
        const Vec3 way = problem.position[start + a] - problem.position[start + b];
        problem.add(DistanceConstraint{{start + a, start + b}, norm(way), norm(way)}, ItemKey{});
      }
    for (int count = 0; count < 3; ++count) {
      ContactConstraint c;
      c.set_directions({{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}});
      c.friction = u(random), c.reference = 0.1;
      const std::uint32_t corner = start + static_cast<std::uint32_t>(count);
      for (const int arm : {0, 1}) {
        c.add(arm, corner, 1);
        if (body > 0) c.add(arm, start - 1, -1);
      }
      if (body > 0) c.first_side = 1;
      problem.add(c, ItemKey{});
    }
  }
}

TEST(HeapPoints, move_the_bodies_of_a_column_alike_with_any_number_of_others_beside_it) {
  constexpr double h = 1.0 / 60;
  const auto advance = [](Problem& problem) {
    problem.gravity = {0, -9.81, 0};
    auto& contacts = problem.pool_of<ContactConstraint>();
    contacts.multipliers.resize(ContactConstraint::rows * contacts.items.size());
    Heap heap;
    ASSERT_TRUE(heap.find_bodies(problem));
    for (int i = 0; i < 20; ++i) (void)heap.advance(problem, h, 0, 1);
  };
  constexpr unsigned columns = 7;
  Problem together;
  for (unsigned seed = 0; seed < columns; ++seed) add_column(together, seed);
  advance(together);
  for (unsigned seed = 0; seed < columns; ++seed) {
    Problem alone;
    add_column(alone, seed);
    const std::vector<Vec3> before = alone.position;
    advance(alone);
    const std::size_t first = seed * alone.size();
    for (std::size_t k = 0; k < alone.size(); ++k) {
      EXPECT_NE(alone.position[k], before[k]);
      EXPECT_EQ(alone.position[k], together.position[first + k]) << seed << " " << k;
      EXPECT_EQ(alone.velocity[k], together.velocity[first + k]) << seed << " " << k;
    }
  }
}

}  // namespace
}  // namespace iota::solver
