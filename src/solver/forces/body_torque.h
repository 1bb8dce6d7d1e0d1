// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"

#include <array>
#include <cstdint>

namespace iota::solver {

/// A torque from outside on a rigid body, as forces on its points that add up to zero: f_i = a x (x_i - c), c the mean of
/// the points, I a = T with I the inertia of points of mass 1. Evaluated where the scheme takes its moments (in the middle
/// of a step, or at its end), so that the angular momentum of a step is T h, however far the body turns. Forces that are
/// held lose the moment that their arms lose: at half a turn a step all of it. On two points there is no torque about
/// their line.
/// The matrix does not have its derivative, of T h^2 / I: Newton's method converges linearly, by the angle that the torque
/// turns the body in a step.
struct BodyTorque {
  static constexpr int max_nodes = 4;
  std::array<std::uint32_t, max_nodes> nodes{};
  std::uint32_t count = 0;
  Vec3 torque;  ///< N m

  using Forces = std::array<Vec3, max_nodes>;
  /// place(node): where it is.
  template <class Place>
  Forces forces(Place place) const {
    const Arms arms(*this, place);
    const Vec3 turn = solve_semidefinite(arms.inertia, torque);
    Forces out;
    for (std::uint32_t i = 0; i < count; ++i) out[i] = cross(turn, arms.of[i]);
    return out;
  }
  /// The angular velocity of the points, rad/s.
  template <class Place, class Velocity>
  Vec3 turning(Place place, Velocity velocity) const {
    const Arms arms(*this, place);
    Vec3 momentum;
    for (std::uint32_t i = 0; i < count; ++i) momentum += cross(arms.of[i], velocity(nodes[i]));
    return solve_semidefinite(arms.inertia, momentum);
  }
  Forces forces_in_step(const Vec3* x0, const Vec3* x1, bool midpoint) const {
    return forces([&](std::uint32_t node) { return midpoint ? 0.5 * (x0[node] + x1[node]) : x1[node]; });
  }
  double work(const Vec3* x0, const Vec3* x1, bool midpoint) const {
    const Forces all = forces_in_step(x0, x1, midpoint);
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) sum += dot(all[i], x1[nodes[i]] - x0[nodes[i]]);
    return sum;
  }

 private:
  struct Arms {
    std::array<Vec3, max_nodes> of;
    Mat3 inertia;
    template <class Place>
    Arms(const BodyTorque& t, Place place) {
      Vec3 center;
      for (std::uint32_t i = 0; i < t.count; ++i) of[i] = place(t.nodes[i]), center += of[i];
      center *= 1.0 / t.count;
      for (std::uint32_t i = 0; i < t.count; ++i) of[i] -= center, inertia += point_inertia(1, of[i]);
    }
  };
};

}  // namespace iota::solver
