// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace iota::solver {
namespace {

void add_length(Problem& problem, std::uint32_t a, std::uint32_t b) {
  problem.add(DistanceConstraint{{a, b}, 1, 1}, ItemKey{});
}

TEST(HeapBodies, of_rods_that_share_points_have_all_of_their_mass_between_them) {
  Problem problem;  // rods of 1, 1000 and 3 kg, end to end, and a ball beside them
  problem.add_nodes(5);
  const double masses[] = {1, 1000, 3};
  for (std::uint32_t k = 0; k < 3; ++k) {
    add_length(problem, k, k + 1);
    problem.add_mass(k, masses[k] / 3), problem.add_mass(k + 1, masses[k] / 3);
    problem.couple_masses(k, k + 1, masses[k] / 6);
  }
  problem.add_mass(4, 7);
  HeapBodies bodies;
  ASSERT_TRUE(bodies.find(problem));
  std::vector<double> found(bodies.all.size(), 0);
  for (std::size_t i = 0; i < bodies.all.size(); ++i)
    for (std::uint32_t k = 0; k < bodies.all[i].count; ++k)
      found[i] += bodies.all[i].shares[k] * problem.mass[bodies.all[i].nodes[k]];
  for (const HeapBodies::Coupling& c : bodies.couplings)
    found[c.body] += 2 * c.share * problem.mass_couplings[c.item].mass;
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), 4u);
  const double wanted[] = {1, 3, 7, 1000};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[i], wanted[i], 1e-9 * wanted[i]);
  EXPECT_EQ(bodies.copies.size(), 2u);
}

TEST(HeapBodies, are_tetrahedra_triangles_rods_and_points_as_lengths_say) {
  Problem problem;  // a tetrahedron and a triangle with a common edge; a square without diagonals; a point
  problem.add_nodes(10);
  for (std::uint32_t node = 0; node < 10; ++node) problem.add_mass(node, 1);
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b) add_length(problem, a, b);
  add_length(problem, 2, 4), add_length(problem, 3, 4);
  for (const auto& [a, b] : {std::pair{5u, 6u}, {6u, 7u}, {7u, 8u}, {8u, 5u}}) add_length(problem, a, b);
  HeapBodies bodies;
  ASSERT_TRUE(bodies.find(problem));
  std::vector<std::uint32_t> counts;
  for (const HeapBody& body : bodies.all) counts.push_back(body.count);
  std::sort(counts.begin(), counts.end());
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{1, 2, 2, 2, 2, 3, 4}));
  EXPECT_EQ(bodies.copies.size(), 6u);
  for (std::uint32_t node = 0; node < 10; ++node) {
    double sum = 0;
    for (const HeapBody& body : bodies.all)
      for (std::uint32_t k = 0; k < body.count; ++k) sum += body.nodes[k] == node ? body.shares[k] : 0;
    EXPECT_NEAR(sum, 1, 1e-12) << node;
  }
}

TEST(HeapBodies, are_not_found_where_a_driven_body_shares_a_point) {
  Problem problem;
  problem.add_nodes(3);
  for (std::uint32_t node = 0; node < 3; ++node) problem.add_mass(node, 1);
  add_length(problem, 0, 1), add_length(problem, 1, 2);
  for (const std::uint32_t node : {0u, 1u}) {
    AffineConstraint nail;
    nail.nodes[0] = node, nail.weights[0] = 1, nail.count = 1;
    problem.add(nail, ItemKey{});
  }
  HeapBodies bodies;
  EXPECT_FALSE(bodies.find(problem));
}

/// Turned by many short parts of the time, each about the spin in its middle.
Quaternion turned_by_short_parts(HeapBody body, HeapMotion motion, double time) {
  constexpr int parts = 20000;
  const Vec3 angular = body.angular_momentum(motion.spin);
  const auto spin_at = [&](const Quaternion& turn) {
    return rotate(turn, body.by_inertia_at_begin * rotate(conjugate(turn), angular));
  };
  Quaternion turn = body.turn;
  for (int k = 0; k < parts; ++k) {
    const Quaternion half = multiply(turn_by((0.5 * time / parts) * spin_at(turn)), turn);
    turn = normalized(multiply(turn_by((time / parts) * spin_at(half)), turn));
  }
  return turn;
}

TEST(HeapBodies, turn_freely_with_their_angular_momentum_in_short_and_long_sub_steps) {
  const Mat3 uneven{{{2, 0.3, 0}, {0.3, 3, -0.2}, {0, -0.2, 4}}};
  for (const bool is_even : {true, false})
    for (const double h : {1e-3, 0.02}) {  // the longer one turns by more than the series is for
      HeapBody body;
      HeapMotion motion;
      body.turned = Mat3::diagonal(1);
      body.is_even = is_even, body.inertia = is_even ? Mat3::diagonal(2.5) : uneven;
      for (int k = 0; k < 3; ++k) body.by_inertia_at_begin.set_column(k, solve(body.inertia, unit_vector(k)));
      motion.by_inertia = body.by_inertia_at_begin, motion.by_mass = 1;
      motion.velocity = {1, 2, 3}, motion.spin = {20, -4, 9};
      const Vec3 angular = body.angular_momentum(motion.spin);
      EXPECT_LT(norm(angular - body.inertia * motion.spin), 1e-12);
      const Quaternion wanted = turned_by_short_parts(body, motion, 2 * h);
      for (int k = 0; k < 2; ++k) body.move(h, motion);
      EXPECT_LT(norm(body.moved - 2 * h * Vec3{1, 2, 3}), 1e-15);
      EXPECT_LT(norm(body.angular_momentum(motion.spin) - angular), 1e-12 * norm(angular));
      const Quaternion off = multiply(conjugate(wanted), body.turn);
      const double most = is_even ? 1e-12 : 50 * h * h;  // of second order
      EXPECT_LT(2 * norm(Vec3{off.x, off.y, off.z}), most) << is_even << " " << h;
      for (int k = 0; k < 3; ++k)
        EXPECT_LT(norm(body.turned * unit_vector(k) - rotate(body.turn, unit_vector(k))), 1e-14);
    }
}

}  // namespace
}  // namespace iota::solver
