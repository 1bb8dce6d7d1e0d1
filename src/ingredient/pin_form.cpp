// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pin_form.h"

#include "ingredient/joint_frames.h"
#include "math/mat3.h"

#include <iota/constraints.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace iota::ingredient {

using namespace joint;

// ---------------------------------------------------------------------------------------------------------- its rows

bool PinForm::has_angle(const Constraint& c) {
  return c.has(a_side) && (info(c.kind).cross || (c.has(b_side) && (c.has(a_axis) || c.has(b_axis))));
}

bool PinForm::has_second_angle(const Constraint& c) { return info(c.kind).second_angle && c.has(b_side); }

solver::AngleConstraint PinForm::angle_row(const JointArms& j) {
  solver::AngleConstraint row;
  const bool cross = info(j.c.kind).cross;
  j.sides(row, {a_origin, a_axis, a_side}, {b_origin, b_axis, b_side});
  j.direction(row, 0, j.c.has(a_axis) ? a_axis : b_axis);
  j.direction(row, 1, cross ? b_axis : b_side);
  j.direction(row, 2, a_side);
  return row;
}

solver::AngleConstraint PinForm::second_angle_row(const JointArms& j) {
  solver::AngleConstraint row;
  j.sides(row, {a_origin, a_axis}, {b_origin, b_axis, b_side});
  j.direction(row, 0, b_axis), j.direction(row, 1, b_side), j.direction(row, 2, a_axis);
  return row;
}

solver::BilinearConstraint PinForm::slide_row(const JointArms& j) {
  solver::BilinearConstraint row;
  const int axis = j.c.has(b_axis) ? b_axis : a_axis;
  j.sides(row, {a_origin, a_axis}, {b_origin, b_axis});
  j.add(row, 0, a_origin, 1), j.add(row, 0, b_origin, -1);
  j.direction(row, 1, axis);
  row.scale = j.c.scale[axis >= b_origin];
  row.reference = std::max(j.c.scale[0], j.c.scale[1]);
  return row;
}

solver::CouplingConstraint PinForm::screw_row(const JointArms& j) {
  solver::CouplingConstraint row;
  const auto turned = angle_row(j);
  const auto slid = slide_row(j);
  const auto list = [&](const auto& part, std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t i = from; i < to; ++i) (void)row.list_node(part.nodes[i]);
  };
  list(turned, 0, turned.first_side), list(slid, 0, slid.first_side);
  row.first_side = row.count;
  list(turned, 0, turned.count), list(slid, 0, slid.count);
  row.add(j.c.length, turned), row.add(-1, slid);
  return row;
}

solver::BilinearConstraint PinForm::line_row(const JointArms& j, int across) {
  solver::BilinearConstraint row;
  const int place = j.c.line_side ? across + b_origin : across;
  j.sides(row, {a_origin, a_side, a_third}, {b_origin, b_side, b_third});
  j.add(row, 0, a_origin, 1), j.add(row, 0, b_origin, -1);
  j.direction(row, 1, place);
  row.scale = j.c.scale[j.c.line_side];
  row.reference = std::max(j.c.scale[0], j.c.scale[1]);
  return row;
}

solver::FrictionLineConstraint PinForm::friction_line_row(const JointArms& j) {
  solver::FrictionLineConstraint row;
  j.sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
  j.add(row, 0, a_origin, 1), j.add(row, 0, b_origin, -1);
  const int first = j.c.line_side ? b_origin : a_origin;
  const std::array<int, 3> places{j.c.has(b_axis) ? b_axis : a_axis, first + a_side, first + a_third};
  for (int arm = 1; const int place : places) {
    const int origin = place < b_origin ? a_origin : b_origin;
    const double scale = 1 / j.c.scale[place >= b_origin];
    j.add(row, arm, place, scale), j.add(row, arm, origin, -scale);
    ++arm;
  }
  row.reference = std::max(j.c.scale[0], j.c.scale[1]);
  return row;
}

solver::AffineConstraint PinForm::equal_axes_row(const JointArms& j) {
  return j.sum_of({{a_axis, 1 / j.c.scale[0]},
                   {a_origin, -1 / j.c.scale[0]},
                   {b_axis, -1 / j.c.scale[1]},
                   {b_origin, 1 / j.c.scale[1]}});
}

solver::BilinearConstraint PinForm::product_row(const JointArms& j, int p, int q, double cosine) {
  solver::BilinearConstraint row;
  j.sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
  j.direction(row, 0, p), j.direction(row, 1, q);
  row.product = cosine * j.c.scale[0] * j.c.scale[1];
  row.scale = std::max(j.c.scale[0], j.c.scale[1]);
  row.reference = std::min(j.c.scale[0], j.c.scale[1]);
  return row;
}

// ------------------------------------------------------------------------------------------------------- its frames

namespace {

/// The directions that a joint needs on its two sides, checked before any change.
struct Frames {
  std::array<Vec3, place_count> direction{};
  std::uint8_t needed = 0;
  std::array<double, 2> cosines{};
  Constraint::Alignment alignment = Constraint::Alignment::none;
  Constraint::Lock lock = Constraint::Lock::none;
  std::uint8_t aligned = 0;
  std::uint8_t line_side = 0;

  void need(int place, const Vec3& d) { direction[place] = d, needed |= static_cast<std::uint8_t>(1u << place); }
  bool has(int place) const { return needed >> place & 1; }
};

/// A direction normal to z that the thinner side holds, if one of them is thin.
Vec3 common_side(const Side& a, const Side& b, const Vec3& z) {
  const Side& thin = b.dimensions < a.dimensions ? b : a;
  Vec3 x;
  if (thin.dimensions == 2) x = cross(cross(thin.axes[0], thin.axes[1]), z);
  if (norm(x) < Side::straight && (thin.dimensions == 1 || thin.dimensions == 2))
    x = thin.axes[0] - dot(thin.axes[0], z) * z;
  return norm(x) < Side::straight ? any_perpendicular(z) : unit(x);
}

/// A common axis, depending on the sides: an axis on one and two directions normal to it on the other; or the angles of
/// the axis with the directions of a thin other side; or the axis on both. False if none of these is possible.
bool plan_alignment(Frames& frames, const Side& a, const Side& b, const Vec3& z, const Vec3& x, const Vec3& y) {
  using Alignment = Constraint::Alignment;
  const auto by_axis_of = [&](const Side& p, const Side& q, int axis, int side) {
    if (!p.holds(z) || !q.holds(x) || !q.holds(y)) return false;
    frames.alignment = axis == a_axis ? Alignment::axis_of_a : Alignment::axis_of_b;
    frames.aligned = 2;
    frames.need(axis, z), frames.need(side, x), frames.need(side + 1, y);
    return true;
  };
  if (by_axis_of(a, b, a_axis, b_side) || by_axis_of(b, a, b_axis, a_side)) return true;
  if (a.holds(z) && b.holds(z)) {
    frames.alignment = Alignment::axes;
    frames.need(a_axis, z), frames.need(b_axis, z);
    return true;
  }
  const auto by_angles = [&](const Side& p, const Side& q, int axis, int side) {
    if (!p.holds(z) || q.dimensions == 0 || q.dimensions == 3) return false;
    frames.alignment = axis == a_axis ? Alignment::axis_of_a : Alignment::axis_of_b;
    frames.need(axis, z);
    frames.aligned = static_cast<std::uint8_t>(q.dimensions);
    if (q.dimensions == 1) {
      frames.need(side, q.axes[0]);
      frames.cosines = {dot(z, q.axes[0]), 0};
    } else {
      const Vec3 other = unit(cross(cross(q.axes[0], q.axes[1]), x));
      frames.need(side, x), frames.need(side + 1, other);
      frames.cosines = {0, dot(z, other)};
    }
    return true;
  };
  return by_angles(a, b, a_axis, b_side) || by_angles(b, a, b_axis, a_side);
}

Frames plan(const ConstraintKindInfo& kind, const JointSpec& spec, const Side& a, const Side& b) {
  Frames frames;
  frames.need(a_origin, {}), frames.need(b_origin, {});
  if (!kind.align && !kind.cross) return frames;
  const Vec3 z = unit(spec.axis);
  const Side& thin = b.dimensions < a.dimensions ? b : a;

  if (kind.cross) {
    const bool any = spec.second_axis == Vec3{};
    const Vec3 second = any ? common_side(a, b, z) : unit(spec.second_axis);
    if (std::abs(dot(z, second)) > Side::straight) cannot(kind.name, "its two axes must be at right angles");
    if (!a.holds(z) || !b.holds(second))
      cannot(kind.name, (a.holds(z) ? b : a).what() +
                            " and does not hold the axis that it should; give it a particle off its line or plane");
    frames.need(a_axis, z), frames.need(b_axis, second);
    if (a.holds(second)) frames.need(a_side, second);
    if (b.holds(z)) frames.need(b_side, z);
    return frames;
  }

  const bool point = thin.dimensions == 0;
  if (point && !kind.line) cannot(kind.name, thin.what() + ", which has no directions; use a ball joint or a nail");
  const Vec3 x = common_side(a, b, z), y = cross(z, x);
  if (!point && !plan_alignment(frames, a, b, z, x, y))
    cannot(kind.name, "neither side holds the axis (" + a.what() + (b.is_world() ? "" : ", " + b.what()) +
                          "); give one of them a massive particle off its line or plane, or join them at two points");
  const bool along_thin = thin.dimensions == 1 && thin.holds(z);  // its rotation about the axis is undefined
  if (!point && !along_thin && (kind.lock || kind.angle)) {
    // References of the angle, or of the last direction that is locked.
    const auto refer = [&](const Side& s, int side) {
      if (!frames.has(side) && s.holds(x)) frames.need(side, x);
    };
    refer(a, a_side), refer(b, b_side);
    if (kind.lock) {
      // y of the side that already holds it, if any.
      const bool y_of_b = frames.has(a_side) && b.holds(y), y_of_a = frames.has(b_side) && a.holds(y);
      if (!y_of_a && !y_of_b)
        cannot(kind.name,
               a.what() + ", " + b.what() +
                   ": they hold no direction across the axis in common; combine() makes one rigid body of them");
      if (y_of_b && (frames.has(b_third) || !y_of_a))
        frames.lock = Constraint::Lock::side_of_a, frames.need(b_third, y);
      else
        frames.lock = Constraint::Lock::third_of_a, frames.need(a_third, y);
    }
  }
  if (kind.line) {
    const bool by_b = b.holds(x) && b.holds(y);
    if (!by_b && !(a.holds(x) && a.holds(y)))
      cannot(kind.name,
             "neither side holds the directions across the axis; give one of them a particle off its line or plane");
    frames.line_side = by_b;
    frames.need(by_b ? b_side : a_side, x), frames.need(by_b ? b_third : a_third, y);
    frames.need(by_b ? b_axis : a_axis, z);
  }
  if (kind.plane && b.holds(z)) frames.need(b_axis, z);
  return frames;
}

void require_span(const Model& model, const char* kind, const Side& side, const Vec3& at) {
  if (side.is_world() || model.spans(side.body, at)) return;
  cannot(kind, side.what() + " and does not reach (" + std::to_string(at.x) + ", " + std::to_string(at.y) + ", " +
                   std::to_string(at.z) + "); give it a massive particle off its point, line or plane");
}

}  // namespace

std::uint32_t make_constraint(Model& model, const JointSpec& spec) {
  const ConstraintKindInfo& kind = info(spec.kind);
  const Side a(model, spec.a.slot);
  const Side b = spec.b ? Side(model, spec.b.slot) : Side();
  if (kind.screw && (a.dimensions < 2 || b.dimensions < 2))
    cannot(kind.name, (a.dimensions < 2 ? a : b).what() +
                          " and does not show how far it has turned; give it a massive particle off its line");
  const Frames frames = plan(kind, spec, a, b);
  const auto origin_of = [&](const Side& s) {
    return kind.meet || kind.line || kind.plane || s.is_world() ? spec.at : model.center_of_mass(s.body);
  };
  require_span(model, kind.name, a, origin_of(a));
  require_span(model, kind.name, b, origin_of(b));

  Constraint c;
  c.kind = spec.kind;
  c.options = {spec.angle, spec.slide, spec.second_angle};
  c.breaks = spec.breaks;
  c.cosines = frames.cosines;
  c.alignment = frames.alignment, c.aligned = frames.aligned, c.lock = frames.lock, c.line_side = frames.line_side;
  const double extent = std::max(a.extent, b.extent);
  for (int side = 0; side < 2; ++side) {
    const double own = side == 0 ? a.extent : b.extent;
    c.scale[side] = own > 0 ? own : extent > 0 ? extent : 1;
  }
  c.particles.fill(none);
  for (int place = 0; place < place_count; ++place) {
    if (!frames.has(place)) continue;
    const Side& side = place < b_origin ? a : b;
    add_place(model, c, place, side.body, origin_of(side) + c.scale[place >= b_origin] * frames.direction[place]);
  }
  constexpr double turn = 2 * std::numbers::pi;
  if (kind.screw) c.length = spec.lead / turn;
  return Joints::add(model, c);
}

}  // namespace iota::ingredient
