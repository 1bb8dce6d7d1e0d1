// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/joint_rows.h"

namespace iota::ingredient::joint {

/// A particle on a surface that is fixed in b's frame, or on one side of it.
struct SurfaceForm : PlainForm {
  static constexpr Form form = Form::surface;

  template <class Sink>
  static void build(const JointArms& j, RowSink<Sink>& out) {
    out.hold(surface_row(j));
  }

  static void make_geometry(const Model&, const Constraint&, ConstraintGeometry&);

 private:
  static solver::SurfaceConstraint surface_row(const JointArms&);
};

/// Two surfaces that touch or do not overlap, each fixed in the frame of its side. The nearest points are found again
/// from those of the last step.
struct SurfacePairForm : PlainForm {
  static constexpr Form form = Form::surface_pair;

  template <class Sink>
  static void build(const JointArms& j, RowSink<Sink>& out) {
    out.hold(pair_row(j));
  }

  using PlainForm::load, PlainForm::store;
  static void load(solver::SurfacePairConstraint& row, const Model&, const Constraint& c, double*) {
    row.nearest = c.nearest;
  }
  static void store(const solver::SurfacePairConstraint& row, Constraint& c, const double*) { c.nearest = row.nearest; }

  static void make_geometry(const Model&, const Constraint&, ConstraintGeometry&);
  static void start(Model&, std::uint32_t joint);

 private:
  static solver::SurfacePairConstraint pair_row(const JointArms&);
};

}  // namespace iota::ingredient::joint
