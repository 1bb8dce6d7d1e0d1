// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/joint_readings.h"
#include "ingredient/joint_rows.h"

#include <optional>

namespace iota::ingredient::joint {

/// A sum of coordinates of other joints that is constant or bounded. Its row is made of theirs and has their places.
struct CouplingForm : PlainForm {
  static constexpr Form form = Form::coupling;

  template <class Sink>
  static void build(const JointArms&, RowSink<Sink>&) {}
  /// By the nodes of an island; none if one of its joints does not act.
  static std::optional<solver::CouplingConstraint> row_of(const IslandMap&, const Constraint&);

  using PlainForm::load;
  static void load(solver::CouplingConstraint&, const Model&, const Constraint&, double*);
  static Violation calc_violation(const Model&, const Constraint&);
  /// The size of the largest term: of a radian, or the length of the slide's directions.
  static double size_of(const Model&, const Constraint&);

  /// Removes the terms from the lists of their joints.
  static void remove_terms(Model&, std::uint32_t coupling);
  /// Each term must be once in its coupling's list, and once in its joint's.
  static void check_terms(const Model&, model::Audit&);
};

}  // namespace iota::ingredient::joint
