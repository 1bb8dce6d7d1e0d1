// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/joint_rows.h"

namespace iota::ingredient::joint {

inline void set_target(solver::AngleConstraint& row, double now, double target) {
  row.target_start = row.target = target;
  row.near = now;
}
inline void set_target(solver::BilinearConstraint& row, double, double target) { row.product = target * row.scale; }

/// A joint between two bodies, with a frame on each: its kind says which of the rows below it has.
struct PinForm : PlainForm {
  static constexpr Form form = Form::pin;

  template <class Sink>
  static void build(const JointArms& j, RowSink<Sink>& out) {
    const ConstraintKindInfo& kind = info(j.c.kind);
    if (kind.meet) out.hold(j.sum_of({{a_origin, 1}, {b_origin, -1}}));
    if (kind.line && rubs(j.c))
      out.hold(friction_line_row(j));
    else if (kind.line)
      for (const int across : {a_side, a_third}) out.hold(line_row(j, across));
    if (kind.align) align(j, out);
    if (j.c.lock == Constraint::Lock::side_of_a) out.hold(product_row(j, a_side, b_third, 0), angle);
    if (j.c.lock == Constraint::Lock::third_of_a) out.hold(product_row(j, a_third, b_side, 0), angle);
    if (kind.cross) out.hold(product_row(j, a_axis, b_axis, 0), angle);
    if (kind.plane) out.hold(slide_row(j));
    if (kind.screw) out.hold(screw_row(j));
    if (kind.angle && has_angle(j.c)) out.coordinate(angle, angle_row(j));
    if (kind.slide) out.coordinate(slide, slide_row(j));
    if (has_second_angle(j.c)) out.coordinate(second_angle, second_angle_row(j));
  }

  template <class Visit>
  static bool with_coordinate(const JointArms& j, JointCoordinate which, Visit visit) {
    if (which == JointCoordinate::slide) return visit(slide_row(j)), true;
    const bool second = which == JointCoordinate::second_angle;
    if (second ? !has_second_angle(j.c) : !has_angle(j.c)) return false;
    visit(second ? second_angle_row(j) : angle_row(j));
    return true;
  }

  using PlainForm::load;
  static void load(solver::FrictionLineConstraint& line, const Model&, const Constraint& c, double*) {
    line.friction = c.options[slide].friction_coefficient;
  }
  static void load(solver::CouplingConstraint& screw, const Model&, const Constraint& c, double*) {
    std::get<solver::AngleConstraint>(screw.terms[0].coordinate).near = c.coordinate[angle];
  }

  /// Whether its slide has a friction coefficient. Then the first three multipliers are those of its line, the third is
  /// the friction along it.
  static bool rubs(const Constraint& c) { return c.options[slide].friction_coefficient > 0; }

 private:
  /// The rows of the common axis.
  template <class Sink>
  static void align(const JointArms& j, RowSink<Sink>& out) {
    using Alignment = Constraint::Alignment;
    if (j.c.alignment == Alignment::axes) return out.hold(equal_axes_row(j), angle);
    if (j.c.alignment == Alignment::none) return;
    const bool of_a = j.c.alignment == Alignment::axis_of_a;
    const int axis = of_a ? a_axis : b_axis, side = of_a ? b_side : a_side;
    out.hold(product_row(j, axis, side, j.c.cosines[0]), angle);
    if (j.c.aligned == 2) out.hold(product_row(j, axis, side + 1, j.c.cosines[1]), angle);
  }

  static bool has_angle(const Constraint&);
  static bool has_second_angle(const Constraint&);
  /// From b's reference to a's, about the axis.
  static solver::AngleConstraint angle_row(const JointArms&);
  /// From b's reference to a's axis, about b's.
  static solver::AngleConstraint second_angle_row(const JointArms&);
  /// The place of a's origin relative to b's along the axis. product / scale is the target in m.
  static solver::BilinearConstraint slide_row(const JointArms&);
  /// The slide is `length` times the angle.
  static solver::CouplingConstraint screw_row(const JointArms&);
  /// The origins are on one line along the axis, in one of the directions across it.
  static solver::BilinearConstraint line_row(const JointArms&, int across);
  /// Both directions across it and the one along it, with friction.
  static solver::FrictionLineConstraint friction_line_row(const JointArms&);
  /// Equal directions: three rows, one of them redundant, which is simpler than a special case.
  static solver::AffineConstraint equal_axes_row(const JointArms&);
  /// The angle between two directions, one of each side, is constant.
  static solver::BilinearConstraint product_row(const JointArms&, int p, int q, double cosine);
};

}  // namespace iota::ingredient::joint
