// SPDX-License-Identifier: Apache-2.0
#include "solver/rigid_motion.h"

namespace iota::solver {

RigidMotion rigid_motion_of(const Problem& problem) {
  RigidMotion motion;
  Vec3 momentum;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    motion.mass += problem.mass[i];
    motion.center += problem.mass[i] * problem.position[i];
    momentum += problem.mass[i] * problem.velocity[i];
  }
  for (const auto& c : problem.mass_couplings) {
    motion.mass += 2 * c.mass;
    motion.center += c.mass * (problem.position[c.a] + problem.position[c.b]);
    momentum += c.mass * (problem.velocity[c.a] + problem.velocity[c.b]);
  }
  if (!(motion.mass > 0)) return {};
  motion.center *= 1 / motion.mass;
  motion.velocity = (1 / motion.mass) * momentum;
  const auto add = [&](double mass, std::uint32_t a, std::uint32_t b) {
    const Vec3 ra = problem.position[a] - motion.center, rb = problem.position[b] - motion.center;
    motion.angular_momentum += mass * cross(ra, problem.velocity[b] - motion.velocity);
    motion.inertia += mass * (Mat3::diagonal(dot(ra, rb)) + -1.0 * Mat3::outer(rb, ra));
  };
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const auto node = static_cast<std::uint32_t>(i);
    add(problem.mass[i], node, node);
  }
  for (const auto& c : problem.mass_couplings) add(c.mass, c.a, c.b), add(c.mass, c.b, c.a);
  motion.turning = solve_semidefinite(motion.inertia, motion.angular_momentum, 1e-12);
  return motion;
}

}  // namespace iota::solver
