// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/constraints.h>

namespace iota::edit {

struct CreateJoint {
  JointSpec spec;
};
struct CreateDistance {
  DistanceSpec spec;
};
struct CreatePath {
  PathSpec spec;
};
struct CreateSurface {
  ingredient::SurfaceConstraintData spec;
};
struct CreateSurfacePair {
  ingredient::SurfacePairData spec;
};
struct CreateSpan {
  SpanSpec spec;
};
struct CreateCoupling {
  CouplingSpec spec;
};
struct CreateTackle {
  TackleSpec spec;
};
struct SetConstraintActive {
  static constexpr std::string_view queued_as = "set_active";
  ConstraintId constraint;
  bool active;
};
struct SetCoordinate {
  static constexpr std::string_view queued_as = "set_coordinate";
  ConstraintId constraint;
  JointCoordinate coordinate;
  CoordinateOptions options;
};
struct SetLength {
  static constexpr std::string_view queued_as = "set_length";
  ConstraintId constraint;
  double value;
};
struct SetBreakLimits {
  ConstraintId constraint;
  BreakLimits limits;
};
struct SetCompliance {
  static constexpr std::string_view queued_as = "set_compliance";
  ConstraintId constraint;
  Compliance compliance;
};

ConstraintId apply(Editor&, const CreateJoint&);
ConstraintId apply(Editor&, const CreateDistance&);
ConstraintId apply(Editor&, const CreatePath&);
ConstraintId apply(Editor&, const CreateSurface&);
ConstraintId apply(Editor&, const CreateSurfacePair&);
ConstraintId apply(Editor&, const CreateSpan&);
ConstraintId apply(Editor&, const CreateCoupling&);
ConstraintId apply(Editor&, const CreateTackle&);
void apply(Editor&, const SetConstraintActive&);
void apply(Editor&, const SetCoordinate&);
void apply(Editor&, const SetLength&);
void apply(Editor&, const SetBreakLimits&);
void apply(Editor&, const SetCompliance&);
void apply(Editor&, const Destroy<ConstraintId>&);

/// Updates the coordinates of a body's joints after places were assigned. In a batch the turns of angles are counted at its end.
void refresh_coordinates_of(Editor&, std::uint32_t body);

}  // namespace iota::edit
