// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// The command that moves a joint to an angle or slide.
namespace iota::edit {

struct SetCoordinateValue {
  ConstraintId constraint;
  JointCoordinate coordinate;
  double value;
};

void apply(Editor&, const SetCoordinateValue&);

}  // namespace iota::edit
