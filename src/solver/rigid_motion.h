// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/problem.h"

#include <cstdint>
#include <optional>
#include <span>

namespace iota::solver {

/// The part of a problem's motion that no internal constraint notices: that of a rigid body with the same momentum and
/// angular momentum. If the problem hangs on one point, the angular momentum is the one about this point. In the mass
/// norm it is orthogonal to the rest of the motion, so that kinetic energies add up.
struct RigidMotion {
  double mass = 0;
  Vec3 center;            ///< of mass, or the point that it hangs on, m
  Vec3 velocity;          ///< of the center, m/s
  Mat3 inertia;           ///< about the center, kg m^2
  Vec3 angular_momentum;  ///< about the center, kg m^2/s
  Vec3 turning;           ///< angular velocity, rad/s

  Vec3 velocity_at(const Vec3& place) const { return velocity + cross(turning, place - center); }
  double kinetic_energy() const { return 0.5 * (mass * dot(velocity, velocity) + dot(turning, inertia * turning)); }
};

/// The rigid motion of the points' masses, without the spins of rods. With `piece_of` only the nodes of one piece count.
RigidMotion rigid_motion_of(const Problem&, std::span<const std::uint32_t> piece_of = {}, std::uint32_t piece = 0);
/// The same for a problem that hangs on one point, about that point.
RigidMotion rigid_motion_about(const Problem&, const Vec3& pivot, std::span<const std::uint32_t> piece_of = {},
                               std::uint32_t piece = 0);

/// Turns an isolated problem, places and velocities, about its center by the least angle that adds some energy (J, of either
/// sign) while its momentum and angular momentum stay: a free body that has lost energy at the same angular
/// momentum has a wrong attitude. With `pivot` the problem hangs on this point, and turns about it; its energy then
/// includes that of gravity and of forces that are held over the step. If the angle is not small, or above `most_angle`, rad,
/// nothing is changed. With `piece_of` only one piece.
void turn_for_energy(Problem&, double energy, double most_angle, const std::optional<Vec3>& pivot = {},
                     std::span<const std::uint32_t> piece_of = {}, std::uint32_t piece = 0);

/// A rigid body about its center of mass or the point that it hangs on; vectors at the begin of the motion.
struct TurningBody {
  Mat3 inertia;           ///< without what spins within it, kg m^2
  Vec3 angular_momentum;  ///< with what spins within it, kg m^2/s
  Vec3 spin;              ///< angular momentum of what spins within it: turns along
  Vec3 torque;            ///< that stays as it is, N m
  Vec3 moment;            ///< mass times the way to the center of mass, kg m: gravity acts there
};
struct Turned {
  Quaternion turn;
  Vec3 angular_momentum, turning;  ///< at the end
};
/// How a rigid body turns in h seconds, by any angle. The angular momentum is exact, the energy to second order.
Turned turn_rigidly(const TurningBody&, const Vec3& gravity, double h);

}  // namespace iota::solver
