// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/joint_rows.h"

namespace iota::ingredient::joint {

inline void set_target(solver::StationConstraint& row, double now, double target) {
  row.target_start = row.target = target;
  row.parameter = now;
}

/// A particle on a curve that is fixed in b's frame; the slide is the length along it.
struct PathForm : PlainForm {
  static constexpr Form form = Form::path;

  template <class Sink>
  static void build(const JointArms& j, RowSink<Sink>& out) {
    out.hold(curve_row(j));
    out.coordinate(slide, station_row(j));
  }

  template <class Visit>
  static bool with_coordinate(const JointArms& j, JointCoordinate which, Visit visit) {
    if (which != JointCoordinate::slide) return false;
    visit(station_row(j));
    return true;
  }

  // The force is stored, as it does not depend on the row's normals.
  using PlainForm::load, PlainForm::store;
  static void load(solver::CurveConstraint& row, const Model&, const Constraint& c, double* multipliers) {
    row.start(c.coordinate[slide], {c.multipliers[0], c.multipliers[1], c.multipliers[2]}, multipliers);
  }
  static void store(const solver::CurveConstraint& row, Constraint& c, const double* multipliers) {
    const Vec3 force = row.force(multipliers);
    c.multipliers[0] = force.x, c.multipliers[1] = force.y, c.multipliers[2] = force.z;
  }

  static void make_geometry(const Model&, const Constraint&, ConstraintGeometry&);

 private:
  static solver::CurveConstraint curve_row(const JointArms&);
  static solver::StationConstraint station_row(const JointArms&);
};

}  // namespace iota::ingredient::joint
