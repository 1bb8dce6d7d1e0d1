// SPDX-License-Identifier: Apache-2.0
#include "solver/rigid_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota::solver {

namespace {

/// visit(mass, a, b) for each node a that counts, as the nail on which several rods hang may not: see Pieces.
template <class Counts, class Visit>
void for_each_coupling(const Problem& problem, Counts counts, Visit visit) {
  for (const auto& c : problem.mass_couplings) {
    if (counts(c.a)) visit(c.mass, c.a, c.b);
    if (counts(c.b)) visit(c.mass, c.b, c.a);
  }
}

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
  for_each_coupling(problem, counts, add);
  motion.inertia = {{{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}}};
  motion.angular_momentum = momentum;
  motion.turning = solve_semidefinite(motion.inertia, motion.angular_momentum, 1e-12);
}

/// The torque of forces from outside on the points, about the center, N m. Gravity does not turn a free problem.
template <class Counts>
Vec3 torque_on(const Problem& problem, const RigidMotion& motion, bool is_free, Counts counts) {
  Vec3 torque;
  for (std::size_t i = 0; i < problem.force.size(); ++i)
    if (counts(i)) torque += cross(problem.position[i] - motion.center, problem.force[i]);
  if (is_free) return torque;
  Vec3 moment;
  for (std::size_t i = 0; i < problem.size(); ++i)
    if (counts(i)) moment += problem.mass[i] * (problem.position[i] - motion.center);
  for_each_coupling(problem, counts, [&](double mass, std::uint32_t a, std::uint32_t) {
    moment += mass * (problem.position[a] - motion.center);
  });
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
  for_each_coupling(problem, counts, [&](double mass, std::uint32_t a, std::uint32_t) {
    motion.mass += mass;
    motion.center += mass * problem.position[a];
    momentum += mass * problem.velocity[a];
  });
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
void turn_for_energy(Problem& problem, double energy, double most_angle, const std::optional<Vec3>& pivot,
                     std::span<const std::uint32_t> piece_of, std::uint32_t piece) {
  constexpr double largest_angle = 0.1;  // rad
  constexpr double most_curved = 0.3;    // of the slope: what it changes by on the way
  constexpr int passes = 4;              // each is right to first order
  const auto counts = [&](std::size_t node) { return piece_of.empty() || piece_of[node] == piece; };
  const auto motion = [&] {
    return pivot ? rigid_motion_about(problem, *pivot, piece_of, piece) : rigid_motion_of(problem, piece_of, piece);
  };
  const auto potential = [&] {
    double sum = pivot ? problem.potential_energy(problem.position.data()) : 0;
    for (std::size_t i = 0; i < problem.force.size(); ++i) sum -= dot(problem.force[i], problem.position[i]);
    return sum;
  };
  for (int pass = 0; pass < passes; ++pass) {
    const RigidMotion before = motion();
    const double potential_before = potential();
    const Vec3 torque = torque_on(problem, before, !pivot, counts);
    const Vec3 slope = -(cross(before.angular_momentum, before.turning) + torque);
    const double steepness = norm(slope), angle = energy / steepness;
    // Beside a principal axis the slope is round-off: a body would jump by up to the largest angle, and gain by the square.
    // Along the line of a heavy rod only what is light and beside it has an inertia, and would be shot away.
    const Vec3 left = cross((1 / steepness) * slope, before.angular_momentum);
    const double curvature =
        2 * before.kinetic_energy() + norm(torque) + dot(left, solve_semidefinite(before.inertia, left, 1e-12));
    const bool is_straight = std::abs(angle) * curvature <= most_curved * steepness;
    if (!(is_straight && std::abs(angle) <= std::min(largest_angle, most_angle) && std::abs(angle) > 1e-15)) return;
    const Quaternion turn = axis_angle((1 / steepness) * slope, angle);
    for (std::size_t i = 0; i < problem.size(); ++i) {
      if (!counts(i)) continue;
      const Vec3 own = problem.velocity[i] - before.velocity_at(problem.position[i]);
      problem.position[i] = before.center + rotate(turn, problem.position[i] - before.center);
      problem.velocity[i] = before.velocity + rotate(turn, own);
    }
    const RigidMotion rest = motion();  // of the rest: none, but for round-off
    const Vec3 turning = solve_semidefinite(rest.inertia, before.angular_momentum - rest.angular_momentum, 1e-12);
    for (std::size_t i = 0; i < problem.size(); ++i)
      if (counts(i)) problem.velocity[i] += cross(turning, problem.position[i] - before.center);
    energy -= motion().kinetic_energy() - before.kinetic_energy() + potential() - potential_before;
  }
}

// With the principal inertias a, b, c, of which a and b are nearest to each other, the energy is
//   (L_a - s_a)^2 / 2a + ... = L^2 / 2a + L_c^2 (1/c - 1/a) / 2 + L_b^2 (1/b - 1/a) / 2 - (w, L) + ...
// where w = s / inertia is of the spins. Each summand alone is a rotation: about L, about axis c, about axis b and about w.
// They follow each other in parts of the step (Touma and Wisdom 1994, doi:10.1086/116931). So the angular momentum is exact,
// and the energy does not drift, even for points that are almost on one line.
Turned turn_rigidly(const TurningBody& body, const Vec3& gravity, double h) {
  constexpr double finest_turn = 0.05, most_parts = 4096, thin = 1e-12;
  const SymmetricEigen inertia = symmetric_eigen(body.inertia);
  std::array<int, 3> order{0, 1, 2};  // from the largest inertia to the smallest
  std::sort(order.begin(), order.end(), [&](int i, int j) { return inertia.values[i] > inertia.values[j]; });
  Turned state{.turn = {}, .angular_momentum = body.angular_momentum, .turning = {}};
  const double largest = inertia.values[order[0]];
  if (!(largest > 0)) return state;
  // 1/inertia; 0 about the line of points that are on one.
  const auto mobility = [&](int axis) { return inertia.values[axis] > thin * largest ? 1 / inertia.values[axis] : 0; };
  if (mobility(order[0]) * inertia.values[order[1]] < mobility(order[1]) * inertia.values[order[2]])
    std::swap(order[0], order[2]);
  const auto [a, b, c] = order;
  const Vec3 &axis_b = inertia.axes[b], &axis_c = inertia.axes[c];
  const double of_all = mobility(a), more_b = mobility(b) - of_all, more_c = mobility(c) - of_all;
  Vec3 against_spin;
  for (int k = 0; k < 3; ++k) against_spin -= (mobility(k) * dot(inertia.axes[k], body.spin)) * inertia.axes[k];

  const auto along = [&](const Vec3& axis) { return dot(rotate(state.turn, axis), state.angular_momentum); };
  const auto turn_about = [&](const Vec3& axis, double angle) {
    state.turn = multiply(state.turn, axis_angle(axis, angle));
  };
  const auto push = [&](double time) {
    state.angular_momentum += time * (body.torque + cross(rotate(state.turn, body.moment), gravity));
  };
  const Vec3 torque = body.torque + cross(body.moment, gravity);
  const double fastest = (norm(body.angular_momentum) + h * norm(torque)) * std::max(of_all, mobility(b));
  const double parts = std::clamp(std::ceil(fastest * h / finest_turn), 1.0, most_parts), part = h / parts;
  for (double k = 0; k < parts; ++k) {
    push(0.5 * part);
    state.turn = multiply(state.turn, turn_by((0.5 * part) * against_spin));
    turn_about(axis_b, 0.5 * part * more_b * along(axis_b));
    turn_about(axis_c, part * more_c * along(axis_c));
    state.turn = multiply(turn_by((part * of_all) * state.angular_momentum), state.turn);
    turn_about(axis_b, 0.5 * part * more_b * along(axis_b));
    state.turn = normalized(multiply(state.turn, turn_by((0.5 * part) * against_spin)));
    push(0.5 * part);
  }
  state.turning = rotate(state.turn, against_spin);
  for (int k = 0; k < 3; ++k)
    state.turning += (mobility(k) * along(inertia.axes[k])) * rotate(state.turn, inertia.axes[k]);
  return state;
}

}  // namespace iota::solver
