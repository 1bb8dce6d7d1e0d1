// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/grips.h>

namespace iota::edit {

struct CreateGrip {
  static constexpr bool keeps_energy = true;
  BodyId body;
  Vec3 local_point, target;
  GripOptions options;
};
struct MoveGrip {
  static constexpr bool keeps_energy = true;
  GripId grip;
  Vec3 target;
};

GripId apply(Editor&, const CreateGrip&);
void apply(Editor&, const MoveGrip&);
void apply(Editor&, const Destroy<GripId>&);

}  // namespace iota::edit
