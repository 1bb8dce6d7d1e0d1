// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/curve.h"
#include "model/structure.h"
#include "shape/data.h"
#include "shape/surface.h"

#include <iota/ids.h>
#include <iota/joint_options.h>
#include <iota/kinds.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace iota {
struct JointSpec;
struct DistanceSpec;
struct PathSpec;
struct SpanSpec;
struct CouplingSpec;
struct TackleSpec;
}  // namespace iota

namespace iota::ingredient {

using model::Model;

/// The places of a constraint. A joint needs a frame on each of its sides: an origin and the ends of directions that
/// start there (axis z, side x, third y). A rod or rope joins the two origins. Curves and surfaces need the whole frame
/// of their body or the world.
enum Place : std::uint8_t { a_origin, a_axis, a_side, a_third, b_origin, b_axis, b_side, b_third };
inline constexpr int place_count = 8;

/// The parts of a kind; `constraint_kinds` lists all. The rows are made by its form, see ingredient/joint_forms.h.
struct ConstraintKindInfo {
  const char* name;
  /// Between bodies, with frames; between two particles; a particle on a curve or surface; two surfaces; or coordinates
  /// of other constraints.
  enum class Form : std::uint8_t { pin, distance, path, surface, surface_pair, coupling } form = Form::pin;
  bool meet = false;   ///< 3 rows: the origins coincide
  bool line = false;   ///< 2 rows: the origins are on one line along the axis
  bool align = false;  ///< 2 rows: the axis is common
  bool lock = false;   ///< 3 rows: no relative rotation
  bool cross = false;  ///< 1 row: a's axis at right angles to b's
  bool plane = false;  ///< 1 row: the origins are in one plane normal to the axis
  bool screw = false;  ///< 1 row: the slide follows the angle
  bool angle = false;  ///< has the coordinate
  bool slide = false;
  bool second_angle = false;
  /// One-sided: the multiplier of its row is never negative (1, pulls), never positive (-1, pushes).
  int sign = 0;

  /// Whether its slide may have a friction coefficient: its line alone guides it.
  bool may_rub() const { return line && !screw; }
  /// Whether it may have a compliance: its rows have fixed directions and are its own.
  bool may_yield() const { return form == Form::pin || (form == Form::distance && !slide); }
};

inline constexpr auto constraint_kinds = std::to_array<ConstraintKindInfo>({
    {.name = "ball", .meet = true},
    {.name = "universal", .meet = true, .cross = true, .angle = true, .second_angle = true},
    {.name = "revolute", .meet = true, .align = true, .angle = true},
    {.name = "cylindrical", .line = true, .align = true, .angle = true, .slide = true},
    {.name = "prismatic", .line = true, .align = true, .lock = true, .slide = true},
    {.name = "orientation", .align = true, .lock = true},
    {.name = "weld", .meet = true, .align = true, .lock = true},
    {.name = "rod", .form = ConstraintKindInfo::Form::distance},
    {.name = "rope", .form = ConstraintKindInfo::Form::distance, .sign = 1},
    {.name = "path", .form = ConstraintKindInfo::Form::path, .slide = true},
    {.name = "surface", .form = ConstraintKindInfo::Form::surface},
    {.name = "inside", .form = ConstraintKindInfo::Form::surface, .sign = 1},
    {.name = "outside", .form = ConstraintKindInfo::Form::surface, .sign = -1},
    {.name = "touching", .form = ConstraintKindInfo::Form::surface_pair},
    {.name = "apart", .form = ConstraintKindInfo::Form::surface_pair, .sign = -1},
    {.name = "span", .form = ConstraintKindInfo::Form::distance, .slide = true},
    {.name = "coupling", .form = ConstraintKindInfo::Form::coupling},
    {.name = "tackle", .form = ConstraintKindInfo::Form::coupling, .sign = 1},
    {.name = "screw", .line = true, .align = true, .screw = true, .angle = true, .slide = true},
    {.name = "planar", .align = true, .plane = true, .angle = true},
});
inline const ConstraintKindInfo& info(ConstraintKind kind) { return constraint_kinds[static_cast<std::size_t>(kind)]; }

/// A surface as plain data: of a shape or, if the key is not 0, of the function with this key.
struct SurfaceData {
  shape::Data shape;
  std::uint64_t function = 0;
};

/// The curve's points are in `Joints::Tables::curve_points`, in the frame of b.
struct CurveData {
  CurveKind kind = CurveKind::spline;
  std::uint8_t closed = 0;
  std::array<std::uint8_t, 2> padding{};
  std::uint32_t first = 0, count = 0, padding2 = 0;
  double rounding = -1;
};

/// A coordinate in the sum of a coupling; it is in two lists.
struct CoupledTerm {
  std::uint32_t coupling = 0, joint = 0;  ///< slots of constraints
  std::uint32_t next = 0;                 ///< of the coupling, in the order in which it was given
  std::uint32_t next_at_joint = 0;
  double ratio = 1;
  JointCoordinate coordinate = JointCoordinate::angle;
  std::array<std::uint8_t, 7> padding{};
};

/// Refers to particles only, so that it follows restructuring; a coupling refers to its terms. Joints make their own
/// massless particles (markers); the world's places are fixed.
struct Constraint {
  ConstraintKind kind = ConstraintKind::ball;
  std::uint8_t active = 1, broken = 0;
  std::uint8_t owned = 0;     ///< bit i: the particle at place i was made for this constraint and is destroyed with it
  std::uint8_t in_world = 0;  ///< bit i: b's place i is one of `fixed`
  /// Rows of the common axis: a's axis and b's other directions, vice versa, or both axes.
  enum class Alignment : std::uint8_t { none, axis_of_a, axis_of_b, axes } alignment = Alignment::none;
  /// The two directions whose right angle fixes the rotation: a's side and b's third, or a's third and b's side.
  enum class Lock : std::uint8_t { none, side_of_a, third_of_a } lock = Lock::none;
  std::uint8_t aligned = 0;    ///< number of directions with a constant angle to the axis
  std::uint8_t line_side = 0;  ///< whose side and third direction hold the line: 0 a's, 1 b's
  /// The one-sided rows that carried a load in the last step: bit 0 itself, the others the stops of its coordinates.
  struct Bits {
    std::uint8_t bits = 0;
    void set(int bit, bool on) { bits = static_cast<std::uint8_t>((bits & ~(1 << bit)) | on << bit); }
    bool operator[](int bit) const { return bits >> bit & 1; }
  };
  Bits carries, told;          ///< at present; and at the last report
  std::uint8_t is_part = 0;    ///< 1: a span made by a tackle and destroyed with it
  std::uint8_t is_new = 1;     ///< no step has held it yet
  std::uint8_t is_hauled = 0;  ///< its length has run in a step: a rod's or rope's row is then a span, for good
  std::array<std::uint32_t, place_count> particles{};  ///< `none` if a place is not needed, or in the world
  /// Each particle lists its places, as links place_count * slot + place.
  std::array<std::uint32_t, place_count> next{}, previous{};
  std::array<Vec3, 4> fixed{};            ///< the world's places as b's, m
  std::array<double, 2> scale{1, 1};      ///< length of the directions of a and b, m
  std::array<double, 2> cosines{};        ///< of the axis and the other's side and third direction
  double length = 0;                      ///< of a rod, rope or path, m; of a coupling: the sum; of a screw: m/rad
  CurveData curve;                        ///< of b
  std::uint32_t first_term = 0xffffffff;  ///< of a coupling
  std::uint32_t coupled = 0xffffffff;     ///< the first of the terms that refer to this constraint's coordinates
  std::array<SurfaceData, 2> surfaces{};  ///< of a and b
  Vec3 nearest;                           ///< of two surfaces: of a to b, in a's frame, m
  std::array<CoordinateOptions, joint_coordinates.size()> options{};
  /// After the last step, rad (counted through full turns) and m.
  std::array<double, joint_coordinates.size()> coordinate{};
  BreakLimits breaks;
  double way = 0;   ///< of the length in the next step, where it runs evenly from length - way to length
  double rate = 0;  ///< that of the length in the last step, 1/s
  Compliance compliance;
  std::array<double, 8> multipliers{};  ///< of the rows that hold it, N; warm start and reaction
  /// Multipliers of limit, motor, friction and spring.
  std::array<std::array<double, 4>, joint_coordinates.size()> efforts{};
  double gap = 0;  ///< after the last step, m

  bool has(int place) const { return particles[place] != 0xffffffff || (in_world >> place & 1); }
};

/// The curve or surface, made from the data: not saved.
struct ConstraintGeometry {
  std::shared_ptr<const geometry::Curve> curve;
  std::array<std::shared_ptr<const shape::Surface>, 2> surfaces;
};

/// Specifications of the public header as plain data.
struct PlacedSurface {
  SurfaceData data;
  Vec3 position;
  Quaternion orientation;
};
struct SurfaceConstraintData {
  ConstraintKind kind;
  ParticleId particle;
  BodyId body;
  PlacedSurface surface;
  BreakLimits breaks;
};
struct SurfacePairData {
  ConstraintKind kind;
  BodyId a, b;
  std::array<PlacedSurface, 2> surfaces;
  BreakLimits breaks;
};

/// Makes a joint with its markers, or a rod or rope. Throws std::invalid_argument, before any change, if a body cannot
/// hold a place or direction that the kind needs.
std::uint32_t make_constraint(Model&, const JointSpec&);
std::uint32_t make_constraint(Model&, const DistanceSpec&);
std::uint32_t make_constraint(Model&, const PathSpec&);
std::uint32_t make_constraint(Model&, const SurfaceConstraintData&);
std::uint32_t make_constraint(Model&, const SurfacePairData&);
std::uint32_t make_constraint(Model&, const SpanSpec&);
std::uint32_t make_constraint(Model&, const CouplingSpec&);
std::uint32_t make_constraint(Model&, const TackleSpec&);
/// The number of points of a coupling's bodies, and its limit.
std::size_t coupled_points(const Model&, const Constraint&);
inline constexpr std::size_t most_coupled_points = 32;
/// The geometry of a constraint from its data; throws std::invalid_argument for invalid sizes and points.
ConstraintGeometry make_geometry(const Model&, const Constraint&);
/// The body of a side (0: a, 1: b), `none` for the world. For a coupling, a of its first and of its last constraint.
std::uint32_t body_of_side(const Model&, const Constraint&, int side);
/// Whether it acts: it is active, neither of its bodies is inactive, and one of them can move.
bool is_in_force(const Model&, const Constraint&);
Vec3 position_of(const Model&, const Constraint&, int place);
/// Unit vector along its axis, world frame; zero for kinds without one.
Vec3 calc_axis(const Model&, const Constraint&);

}  // namespace iota::ingredient
