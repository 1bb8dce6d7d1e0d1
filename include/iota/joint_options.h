// SPDX-License-Identifier: Apache-2.0
// Parts of constraints that the engine keeps as they are given.
#pragma once

#include <iota/vec3.h>

#include <functional>
#include <limits>

namespace iota {

/// Limits, motor, friction and spring of a coordinate. Angles: rad, rad/s, N m, N m/rad, N m s/rad; slides: m, m/s, N, N/m, N s/m.
struct CoordinateOptions {
  double lower = -std::numeric_limits<double>::infinity();  ///< stops, inelastic
  double upper = std::numeric_limits<double>::infinity();
  double motor_speed = 0;
  double motor_max = 0;  ///< largest torque or force of the motor; 0: none. With speed 0 it is a brake
  /// Target of the motor, rad or m; NaN: none. With a target, motor_speed is the largest speed; near the target the
  /// motor slows down such that the distance to it falls as exp(-t / servo_time), servo_time in s.
  double servo = std::numeric_limits<double>::quiet_NaN();
  double servo_time = 0.05;
  double friction = 0;   ///< dry: up to this torque or force against any motion
  double stiffness = 0;  ///< of a spring towards `rest`
  double damping = 0;
  double rest = 0;
  /// Coulomb friction, for the slide of a prismatic or cylindrical joint: up to this times the reaction across the axis.
  double friction_coefficient = 0;
};

/// Loads above which a constraint breaks: it becomes inactive, and the step's report names it.
struct BreakLimits {
  double force = std::numeric_limits<double>::infinity();   ///< N
  double torque = std::numeric_limits<double>::infinity();  ///< N m, about the constraint's place
};

/// Makes a joint, rod or rope yield in the directions that it holds, like a spring. Zero: exact.
struct Compliance {
  double linear = 0;   ///< m/N
  double angular = 0;  ///< rad/(N m)
  double time = 0;     ///< relaxation time: damping over stiffness, s

  friend bool operator==(const Compliance&, const Compliance&) = default;
  bool is_exact() const { return linear == 0 && angular == 0; }
};

/// phi(r) = 0, with phi negative inside and, near the surface, about the distance in m. Called during a step, on any
/// thread; it must not use the system. Not part of snapshots.
struct SurfaceFunction {
  std::function<double(const Vec3&)> phi;
  double size = 1;  ///< of the surface, m
};

}  // namespace iota
