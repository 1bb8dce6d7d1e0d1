// SPDX-License-Identifier: Apache-2.0
// Problems of a few points, made by hand.
#pragma once

#include "gravity.h"

#include "solver/problem.h"

#include <tuple>

namespace iota::solver {

/// The step, s.
constexpr double h = 0.01;

template <class C>
ConstraintPool<C>& pool(Problem& problem) {
  return problem.pool_of<C>();
}
template <class C>
std::size_t add(Problem& problem, const C& c) {
  problem.add(c, {});
  return pool<C>(problem).items.size() - 1;
}
inline std::uint32_t add_point(Problem& problem, const Vec3& x, double mass = 1, const Vec3& v = {}) {
  problem.position.push_back(x), problem.velocity.push_back(v), problem.force.push_back({}),
      problem.mass.push_back(mass);
  return static_cast<std::uint32_t>(problem.size() - 1);
}
inline void nail(Problem& problem, std::uint32_t node) {
  AffineConstraint c;
  c.nodes[0] = node, c.weights[0] = 1, c.count = 1;
  c.target = c.target_start = problem.position[node];
  add(problem, c);
}
/// The row of which bodies are made; its multiplier is the tension, N.
inline std::size_t add_rod(Problem& problem, std::uint32_t a, std::uint32_t b, double length) {
  return add(problem, DistanceConstraint{{a, b}, length, length});
}
inline void add_spring(Problem& problem, std::uint32_t a, std::uint32_t b, double stiffness, double length) {
  SpringForce spring;
  spring.arm.nodes = {a, b}, spring.arm.weights = {-1, 1}, spring.arm.count = 2;
  spring.stiffness = stiffness, spring.length = length;
  problem.add(spring, {});
}
/// x . direction = c for a point, or for the difference of two.
inline BilinearConstraint along(std::uint32_t node, const Vec3& direction, double c) {
  BilinearConstraint row;
  row.add(0, node, 1);
  row.set_constant(1, direction);
  row.product = c;
  return row;
}
inline BilinearConstraint distance(std::uint32_t a, std::uint32_t b, double length) {
  BilinearConstraint row;
  for (const int arm : {0, 1}) row.add(arm, a, -1), row.add(arm, b, 1);
  row.product = length * length, row.scale = 2 * length, row.reference = length;
  return row;
}
/// Rods of length 0.5 in a zigzag, the first point on a nail.
inline Problem zigzag(int rods) {
  Problem problem;
  problem.gravity = {0, -9.81, 0};
  std::uint32_t last = add_point(problem, {});
  nail(problem, last);
  for (int i = 0; i < rods; ++i) {
    const Vec3 along_rod = i % 2 == 0 ? Vec3{0.4, -0.3, 0} : Vec3{0.3, 0, 0.4};
    const std::uint32_t next = add_point(problem, problem.position[last] + along_rod, 0.5 + 0.1 * (i % 3));
    add_rod(problem, last, next, 0.5);
    last = next;
  }
  return problem;
}

}  // namespace iota::solver
