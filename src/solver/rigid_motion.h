// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/problem.h"

#include <cstdint>
#include <optional>
#include <span>

namespace iota::solver {

/// The part of a problem's motion that no internal constraint notices: that of a rigid body with the same momentum and
/// angular momentum; of a problem that hangs on one point, with the same angular momentum about that. In the mass norm it is
/// orthogonal to the rest of the motion, so that kinetic energies add up.
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

/// Of the points' masses only, without the spins of rods. `piece_of`: only of the nodes of one piece.
RigidMotion rigid_motion_of(const Problem&, std::span<const std::uint32_t> piece_of = {}, std::uint32_t piece = 0);
/// About the point that all hangs on.
RigidMotion rigid_motion_about(const Problem&, const Vec3& pivot, std::span<const std::uint32_t> piece_of = {},
                               std::uint32_t piece = 0);

/// Turns an isolated problem, places and velocities, about its center by the least angle that adds some energy (J, of either
/// sign) while its momentum and angular momentum stay: a free body that has lost energy at the same angular
/// momentum has turned its axes off the way they go. `pivot`: or one that hangs on a point, about that; gravity counts.
/// So do forces that are held over the step. Does nothing where that would take more than a small angle.
void turn_for_energy(Problem&, double energy, const std::optional<Vec3>& pivot = {});

}  // namespace iota::solver
