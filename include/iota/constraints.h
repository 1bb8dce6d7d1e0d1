// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/joint_options.h>
#include <iota/kinds.h>
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
  Vec3 second_axis;     ///< the same, of b in a universal joint; otherwise zero
  Vec3 force, torque;   ///< by the constraint on a in the last step, N and N m (about `position`); b has the opposite
  double gap = 0;       ///< largest violation after the last step, m
  double length = 0;    ///< rod, rope, tackle, coupling: m, or rad
  /// Angle (rad, counted through full turns), slide (m), second angle (rad).
  std::array<double, joint_coordinates.size()> coordinate{};
  std::array<double, joint_coordinates.size()> speed{};              ///< rad/s, m/s, rad/s
  std::array<CoordinateEfforts, joint_coordinates.size()> effort{};  ///< in the last step
};

}  // namespace iota
