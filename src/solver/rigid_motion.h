// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/problem.h"

namespace iota::solver {

/// The part of a problem's motion that no internal constraint notices: that of a rigid body with the same momentum and
/// angular momentum. In the mass norm it is orthogonal to the rest of the motion, so that kinetic energies add up.
struct RigidMotion {
  double mass = 0;
  Vec3 center;            ///< of mass, m
  Vec3 velocity;          ///< of the center, m/s
  Mat3 inertia;           ///< about the center, kg m^2
  Vec3 angular_momentum;  ///< about the center, kg m^2/s
  Vec3 turning;           ///< angular velocity, rad/s

  Vec3 velocity_at(const Vec3& place) const { return velocity + cross(turning, place - center); }
  double kinetic_energy() const { return 0.5 * (mass * dot(velocity, velocity) + dot(turning, inertia * turning)); }
};

/// Of the points' masses alone, without the spins of rods.
RigidMotion rigid_motion_of(const Problem&);

}  // namespace iota::solver
