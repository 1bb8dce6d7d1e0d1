// SPDX-License-Identifier: Apache-2.0
#include "solver/rigid_motion.h"

#include <cmath>

namespace iota::solver {

namespace {

/// The sums over a motion, in registers: in the record each addition would wait for the last one's memory.
template <class Counts>
void add_turning(const Problem& problem, Counts counts, RigidMotion& motion) {
  const Vec3 center = motion.center, velocity = motion.velocity;
  Vec3 momentum = motion.angular_momentum;
  double xx = 0, yy = 0, zz = 0, xy = 0, yx = 0, xz = 0, zx = 0, yz = 0, zy = 0;
  const auto add = [&](double mass, std::uint32_t a, std::uint32_t b) {
    const Vec3 ra = problem.position[a] - center, rb = problem.position[b] - center;
    momentum += mass * cross(ra, problem.velocity[b] - velocity);
    const double across = dot(ra, rb);
    xx += mass * (across - rb.x * ra.x), yy += mass * (across - rb.y * ra.y), zz += mass * (across - rb.z * ra.z);
    xy -= mass * (rb.x * ra.y), xz -= mass * (rb.x * ra.z), yz -= mass * (rb.y * ra.z);
    yx -= mass * (rb.y * ra.x), zx -= mass * (rb.z * ra.x), zy -= mass * (rb.z * ra.y);
  };
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const auto node = static_cast<std::uint32_t>(i);
    if (counts(i)) add(problem.mass[i], node, node);
  }
  for (const auto& c : problem.mass_couplings)
    if (counts(c.a)) add(c.mass, c.a, c.b), add(c.mass, c.b, c.a);
  motion.inertia = {{{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}}};
  motion.angular_momentum = momentum;
  motion.turning = solve_semidefinite(motion.inertia, motion.angular_momentum, 1e-12);
}

/// The torque of forces from outside on the points, about the center, N m. Gravity does not turn a free problem.
Vec3 torque_on(const Problem& problem, const RigidMotion& motion, bool is_free) {
  Vec3 torque;
  for (std::size_t i = 0; i < problem.force.size(); ++i)
    torque += cross(problem.position[i] - motion.center, problem.force[i]);
  if (is_free) return torque;
  Vec3 moment;
  for (std::size_t i = 0; i < problem.size(); ++i) moment += problem.mass[i] * (problem.position[i] - motion.center);
  for (const auto& c : problem.mass_couplings)
    moment += c.mass * (problem.position[c.a] - motion.center + problem.position[c.b] - motion.center);
  return torque + cross(moment, problem.gravity);
}

}  // namespace

RigidMotion rigid_motion_of(const Problem& problem, std::span<const std::uint32_t> piece_of, std::uint32_t piece) {
  const auto counts = [&](std::size_t node) { return piece_of.empty() || piece_of[node] == piece; };
  RigidMotion motion;
  Vec3 momentum;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    if (!counts(i)) continue;
    motion.mass += problem.mass[i];
    motion.center += problem.mass[i] * problem.position[i];
    momentum += problem.mass[i] * problem.velocity[i];
  }
  for (const auto& c : problem.mass_couplings) {
    if (!counts(c.a)) continue;
    motion.mass += 2 * c.mass;
    motion.center += c.mass * (problem.position[c.a] + problem.position[c.b]);
    momentum += c.mass * (problem.velocity[c.a] + problem.velocity[c.b]);
  }
  if (!(motion.mass > 0)) return {};
  motion.center *= 1 / motion.mass;
  motion.velocity = (1 / motion.mass) * momentum;
  add_turning(problem, counts, motion);
  return motion;
}

RigidMotion rigid_motion_about(const Problem& problem, const Vec3& pivot, std::span<const std::uint32_t> piece_of,
                               std::uint32_t piece) {
  RigidMotion motion{.center = pivot};
  add_turning(problem, [&](std::size_t node) { return piece_of.empty() || piece_of[node] == piece; }, motion);
  return motion;
}

// The energy (R'L)' I^-1 (R'L) / 2 of a body turned by R = 1 + [a] falls by a . (L x w), its potential energy by a . torque.
void turn_for_energy(Problem& problem, double energy, const std::optional<Vec3>& pivot) {
  constexpr double largest_angle = 0.1;  // rad
  constexpr double most_curved = 0.3;    // of the slope: what it changes by on the way
  constexpr int passes = 4;              // each is right to first order
  const auto motion = [&] { return pivot ? rigid_motion_about(problem, *pivot) : rigid_motion_of(problem); };
  const auto potential = [&] {
    double sum = pivot ? problem.potential_energy(problem.position.data()) : 0;
    for (std::size_t i = 0; i < problem.force.size(); ++i) sum -= dot(problem.force[i], problem.position[i]);
    return sum;
  };
  for (int pass = 0; pass < passes; ++pass) {
    const RigidMotion before = motion();
    const double potential_before = potential();
    const Vec3 torque = torque_on(problem, before, !pivot);
    const Vec3 slope = -(cross(before.angular_momentum, before.turning) + torque);
    const double steepness = norm(slope), angle = energy / steepness;
    // Beside a principal axis the slope is round-off: a body would jump by up to the largest angle, and gain by the square.
    const double curvature = 2 * before.kinetic_energy() + norm(torque);
    const bool is_straight = std::abs(angle) * curvature <= most_curved * steepness;
    if (!(is_straight && std::abs(angle) <= largest_angle && std::abs(angle) > 1e-15)) return;
    const Quaternion turn = axis_angle((1 / steepness) * slope, angle);
    for (std::size_t i = 0; i < problem.size(); ++i) {
      const Vec3 own = problem.velocity[i] - before.velocity_at(problem.position[i]);
      problem.position[i] = before.center + rotate(turn, problem.position[i] - before.center);
      problem.velocity[i] = before.velocity + rotate(turn, own);
    }
    const RigidMotion rest = motion();  // of the rest: none, but for round-off
    const Vec3 turning = solve_semidefinite(rest.inertia, before.angular_momentum - rest.angular_momentum, 1e-12);
    for (std::size_t i = 0; i < problem.size(); ++i)
      problem.velocity[i] += cross(turning, problem.position[i] - before.center);
    energy -= motion().kinetic_energy() - before.kinetic_energy() + potential() - potential_before;
  }
}

}  // namespace iota::solver
