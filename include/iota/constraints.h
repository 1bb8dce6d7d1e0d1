// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/shapes.h>
#include <iota/vec3.h>

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

namespace iota {

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
  rope,         ///< two particles come no further apart than a length
  path,         ///< a particle stays on a curve: one slide, the length along it
  surface,      ///< a particle stays on a surface
  inside,       ///< a particle stays on the inner side of a surface
  outside,      ///< a particle stays on the outer side of a surface
  touching,     ///< two surfaces stay in touch
  apart,        ///< two surfaces do not overlap
  span,         ///< holds nothing: the distance of two particles as a slide, for limits, motors, springs and couplings
  coupling,     ///< a weighted sum of coordinates stays what it is: gears, racks, belts, differentials
  tackle,       ///< a weighted sum of coordinates gets no larger: a rope over several points
  screw,        ///< cylindrical, and slides by its lead with each turn
  planar,       ///< a point of a stays in a plane of b through it, and does not turn out of the plane
};

/// The coordinates that joints have: the angle about the axis (revolute, cylindrical, screw, planar; of a universal joint about a's axis),
/// the slide along it (prismatic, cylindrical, screw), along a path or of a span, and the second angle of a universal joint, about b's axis.
/// All are of a against b, in the positive sense of the axis, and zero where the joint is made.
enum class JointCoordinate : std::uint8_t { angle, slide, second_angle };
inline constexpr std::array joint_coordinates{JointCoordinate::angle, JointCoordinate::slide,
                                              JointCoordinate::second_angle};

bool has_coordinate(ConstraintKind, JointCoordinate);

/// Limits, motor, friction and spring of a coordinate. Angles: rad, rad/s, N m, N m/rad, N m s/rad; slides: m, m/s, N, N/m, N s/m.
struct CoordinateOptions {
  double lower = -std::numeric_limits<double>::infinity();  ///< stops, inelastic
  double upper = std::numeric_limits<double>::infinity();
  double motor_speed = 0;
  double motor_max = 0;  ///< largest torque or force of the motor; 0: none. With speed 0 it is a brake
  /// Where the motor goes, rad or m; NaN: on and on. motor_speed is then the largest speed, and within servo_time (s) of
  /// its aim it slows down such that what is left falls as exp(-t / servo_time).
  double servo = std::numeric_limits<double>::quiet_NaN();
  double servo_time = 0.05;
  double friction = 0;   ///< dry: up to this torque or force against any motion
  double stiffness = 0;  ///< of a spring towards `rest`
  double damping = 0;
  double rest = 0;
};

/// Loads beyond which a constraint breaks: it is then inactive, and the step's report names it.
struct BreakLimits {
  double force = std::numeric_limits<double>::infinity();   ///< N
  double torque = std::numeric_limits<double>::infinity();  ///< N m, about the constraint's place
};

/// A joint between bodies a and b, or between a and the world where b is null. Relative position and orientation are
/// taken from where the bodies are now.
struct JointSpec {
  ConstraintKind kind = ConstraintKind::revolute;
  BodyId a, b;
  Vec3 at;             ///< world frame, m
  Vec3 axis{0, 0, 1};  ///< world frame, any length; of a in a universal joint
  Vec3 second_axis;    ///< of b in a universal joint, at right angles to `axis`; zero: any
  double lead = 0;     ///< of a screw: its slide with each full turn, m; negative: left-handed
  CoordinateOptions angle, slide, second_angle;
  BreakLimits breaks;
};

/// A rod or rope between two particles.
struct DistanceSpec {
  ConstraintKind kind = ConstraintKind::rod;
  ParticleId p, q;
  double length = std::numeric_limits<double>::quiet_NaN();  ///< m; NaN: the distance now
  BreakLimits breaks;
};

enum class CurveKind : std::uint8_t {
  spline,    ///< cubic, through the points
  polyline,  ///< straight pieces with rounded corners
};

/// The distance of two particles, which may be of one body.
struct SpanSpec {
  ParticleId p, q;
  CoordinateOptions slide;
  BreakLimits breaks;
};

/// A coordinate of another constraint in the sum of a coupling, and what it counts there.
struct CoupledCoordinate {
  ConstraintId constraint;
  JointCoordinate coordinate = JointCoordinate::angle;
  double ratio = 1;
};

/// sum of ratio * coordinate = length. It is in force while all of its constraints are, and ends with the first of them.
struct CouplingSpec {
  ConstraintKind kind = ConstraintKind::coupling;  ///< or tackle
  std::vector<CoupledCoordinate> terms;
  double length = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the sum now
  BreakLimits breaks;
};

/// A rope that runs without friction from a particle over others to a last one: the sum of the distances from each to the
/// next is no more than its length. A tackle of spans, which it makes and takes along.
struct TackleSpec {
  std::vector<ParticleId> points;
  double length = std::numeric_limits<double>::quiet_NaN();  ///< m; NaN: the sum now
  BreakLimits breaks;
};

/// A particle on a curve that is fixed in a body or, where that is null, in the world.
struct PathSpec {
  ParticleId particle;
  BodyId body;
  CurveKind curve = CurveKind::spline;
  std::vector<Vec3> points;  ///< world frame, as the body is now, m; two at least, three where closed
  bool closed = false;
  double rounding = -1;  ///< of a polyline's corners, m; negative: a tenth of the shorter piece
  /// Along the path from its first point, m. An open path ends at its ends unless limits say otherwise.
  CoordinateOptions slide;
  BreakLimits breaks;
};

/// phi(r) = 0, with phi negative inside and, near the surface, about the distance in m. Called while the system steps,
/// from any thread; it must not touch the system. Not part of snapshots.
struct SurfaceFunction {
  std::function<double(const Vec3&)> phi;
  double size = 1;  ///< of what it describes, m
};

/// The surface of a shape (but a Mesh), or of a function, with its frame; fixed in a body or in the world.
struct Surface {
  std::variant<Shape, SurfaceFunction> shape;
  Vec3 position;           ///< of the shape's origin, world frame, m
  Quaternion orientation;  ///< turns vectors of the shape's frame into the world frame
};

/// A particle on (surface), inside or outside a surface of a body or, where that is null, of the world.
struct SurfaceSpec {
  ConstraintKind kind = ConstraintKind::surface;
  ParticleId particle;
  BodyId body;
  Surface surface;
  BreakLimits breaks;
};

/// Two surfaces that stay in touch (touching) or do not overlap (apart); b null: the world's.
struct SurfacePairSpec {
  ConstraintKind kind = ConstraintKind::apart;
  BodyId a, b;
  Surface surface_a, surface_b;
  BreakLimits breaks;
};

/// What acts along a coordinate on a, N m or N.
struct CoordinateEfforts {
  double stop = 0, motor = 0, friction = 0, spring = 0;
  double total() const { return stop + motor + friction + spring; }
};

/// The state of a constraint.
struct ConstraintState {
  ConstraintKind kind = ConstraintKind::ball;
  BodyId a, b;  ///< b null: the world
  bool active = true;
  bool broken = false;  ///< by a load beyond its limits; setting it active again repairs it
  Vec3 position;        ///< where it acts on a, m
  Vec3 axis;            ///< unit vector, world frame; zero for kinds without one
  Vec3 force, torque;   ///< by the constraint on a in the last step, N and N m (about `position`); b has the opposite
  double gap = 0;       ///< largest violation after the last step, m
  double length = 0;    ///< rod, rope, tackle, coupling: m, or rad
  /// Angle (rad, counted through full turns), slide (m), second angle (rad).
  std::array<double, joint_coordinates.size()> coordinate{};
  std::array<double, joint_coordinates.size()> speed{};              ///< rad/s, m/s, rad/s
  std::array<CoordinateEfforts, joint_coordinates.size()> effort{};  ///< in the last step
};

}  // namespace iota
