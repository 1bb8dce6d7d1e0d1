// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/joint_rows.h"

namespace iota::ingredient::joint {

inline void set_target(solver::SpanConstraint& row, double, double target) { row.target_start = row.target = target; }

/// A rod, a rope, or the distance of two particles as a coordinate. Its places are the origins, without directions.
struct DistanceForm : PlainForm {
  static constexpr Form form = Form::distance;

  template <class Sink>
  static void build(const JointArms& j, RowSink<Sink>& out) {
    if (j.c.kind == ConstraintKind::span) return out.coordinate(slide, span_row(j));
    // Its stretch is not only nearly the distance, and a length that runs evenly is no square that does.
    if (has_span(j.c)) return out.hold(span_row(j));
    if (j.c.kind == ConstraintKind::rod && joins_nodes(j)) return out.hold(rod_row(j));
    out.hold(square_row(j));
  }

  template <class Visit>
  static bool with_coordinate(const JointArms& j, JointCoordinate which, Visit visit) {
    if (which != JointCoordinate::slide) return false;
    visit(span_row(j));
    return true;
  }

  using PlainForm::load;
  static void load(solver::DistanceConstraint& row, const Model&, const Constraint& c, double*) {
    row.length = row.scale = c.length;
  }
  static void load(solver::BilinearConstraint& row, const Model&, const Constraint& c, double*) {
    set_length(row, c.length);
  }
  static void load(solver::SpanConstraint& row, const Model&, const Constraint& c, double*) {
    set_target(row, c.length, c.length);
  }
  /// Whether a rod or rope has the distance itself as its row, whose multiplier is the tension.
  static bool has_span(const Constraint& c) { return c.is_hauled || !c.compliance.is_exact(); }

 private:
  /// Whether each end is a node of its own.
  static bool joins_nodes(const JointArms&);
  static solver::SpanConstraint span_row(const JointArms&);
  static solver::DistanceConstraint rod_row(const JointArms&);
  /// (|d|^2 - L^2) / 2L: the multiplier is the tension.
  static solver::BilinearConstraint square_row(const JointArms&);
  /// The scale, too: by that of the length with which a rope was made, a hauled one told its force in the ratio of both.
  static void set_length(solver::BilinearConstraint&, double length);
};

}  // namespace iota::ingredient::joint
