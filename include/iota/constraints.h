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

/// A joint between bodies a and b, or between a and the world where b is null. Relative position and orientation are
/// the present ones of the bodies.
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

/// A coordinate of another constraint in the sum of a coupling, and its factor there.
struct CoupledCoordinate {
  ConstraintId constraint;
  JointCoordinate coordinate = JointCoordinate::angle;
  double ratio = 1;
};

/// sum of ratio * coordinate = length. Acts while all its constraints are active; destroyed with the first of them.
struct CouplingSpec {
  ConstraintKind kind = ConstraintKind::coupling;  ///< or tackle
  std::vector<CoupledCoordinate> terms;
  double length = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the sum now
  BreakLimits breaks;
};

/// A rope that runs without friction from a particle over others to a last one: the sum of the distances from each to
/// the next is at most its length. It is a tackle of spans, which it creates and destroys.
struct TackleSpec {
  std::vector<ParticleId> points;
  double length = std::numeric_limits<double>::quiet_NaN();  ///< m; NaN: the sum now
  BreakLimits breaks;
};

/// A particle on a curve that is fixed in a body or, if that is null, in the world.
struct PathSpec {
  ParticleId particle;
  BodyId body;
  CurveKind curve = CurveKind::spline;
  std::vector<Vec3> points;  ///< world frame, as the body is now, m; two at least, three where closed
  bool closed = false;
  double rounding = -1;  ///< of a polyline's corners, m; negative: a tenth of the shorter piece
  /// Along the path from its first point, m. The default limits of an open path are its ends.
  CoordinateOptions slide;
  BreakLimits breaks;
};

/// phi(r) = 0, with phi negative inside and, near the surface, about the distance in m. Called during a step, on any
/// thread; it must not use the system. Not part of snapshots.
struct SurfaceFunction {
  std::function<double(const Vec3&)> phi;
  double size = 1;  ///< of the surface, m
};

/// The surface of a shape (but a Mesh), or of a function, with its frame; fixed in a body or in the world.
struct Surface {
  std::variant<Shape, SurfaceFunction> shape;
  Vec3 position;           ///< of the shape's origin, world frame, m
  Quaternion orientation;  ///< turns vectors of the shape's frame into the world frame
};

/// A particle on (surface), inside or outside a surface of a body or, if that is null, of the world.
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

/// Efforts on a along a coordinate, N m or N.
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
