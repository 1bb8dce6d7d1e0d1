// SPDX-License-Identifier: Apache-2.0
// Enumerations that the engine's own records have: a header of their own, since nearly every file of the engine reads it.
#pragma once

#include <array>
#include <cstdint>

namespace iota {

enum class BodyKind : std::uint8_t {
  dynamic,
  static_,   ///< never moves
  scripted,  ///< moved by the script (set_position, set_pose), infinite mass
  inactive,  ///< kept, but neither stepped nor drawn
  resting,   ///< dynamic, asleep with its whole articulate; wakes when touched, see RestOptions
};

/// Modes from plausible to accurate; can be changed at any time. docs/solver.md lists cost and accuracy of each.
enum class IntegrationMode : std::uint8_t {
  plausible,       ///< `robust` with gaps up to 1e-7 of a link: for distant things
  robust,          ///< backward Euler: never fails, never gains energy, dissipates
  energy_keeping,  ///< mid-point discrete gradient with bisection; falls back to `robust` if a step fails
  accurate,        ///< fifth order, in sub-steps whose estimated errors stay below the tolerance
};

/// Kinds of constraints. Nails and hinges are not in the list: a nail belongs to a particle, a hinge is a shared
/// particle (`combine`).
enum class ConstraintKind : std::uint8_t {
  ball,         ///< a point of a stays at a point of b
  universal,    ///< ball, and an axis of a stays at right angles to an axis of b
  revolute,     ///< ball, and a common axis: one angle
  cylindrical,  ///< a common axis along which b also slides: an angle and a slide
  prismatic,    ///< b slides along an axis of a without turning
  orientation,  ///< b does not turn against a, but moves freely
  weld,         ///< b neither turns nor moves against a
  rod,          ///< two particles keep their distance
  rope,         ///< the distance of two particles is at most a length
  path,         ///< a particle stays on a curve: one slide, the length along it
  surface,      ///< a particle stays on a surface
  inside,       ///< a particle stays on the inner side of a surface
  outside,      ///< a particle stays on the outer side of a surface
  touching,     ///< two surfaces stay in touch
  apart,        ///< two surfaces do not overlap
  span,         ///< makes the distance of two particles a slide, for limits, motors, springs and couplings
  coupling,     ///< a weighted sum of coordinates is constant: gears, racks, belts, differentials
  tackle,       ///< a weighted sum of coordinates has an upper bound: a rope over several points
  screw,        ///< cylindrical; each turn slides by the lead
  planar,       ///< a moves in a plane of b and turns about the plane's normal
};

/// The coordinates that joints have: the angle about the axis (revolute, cylindrical, screw, planar; of a universal joint about a's axis),
/// the slide along it (prismatic, cylindrical, screw), along a path or of a span, and the second angle of a universal joint, about b's axis.
/// All are of a relative to b, in the positive sense of the axis, and zero when the joint is made.
enum class JointCoordinate : std::uint8_t { angle, slide, second_angle };
inline constexpr std::array joint_coordinates{JointCoordinate::angle, JointCoordinate::slide,
                                              JointCoordinate::second_angle};
bool has_coordinate(ConstraintKind, JointCoordinate);

enum class CurveKind : std::uint8_t {
  spline,    ///< cubic, through the points
  polyline,  ///< straight pieces with rounded corners
};

}  // namespace iota
