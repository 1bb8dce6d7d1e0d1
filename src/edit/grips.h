// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::edit {

struct CreateGrip {
  BodyId body;
  Vec3 local_point, target;
  GripOptions options;
};
struct MoveGrip {
  GripId grip;
  Vec3 target;
};

GripId apply(Editor&, const CreateGrip&);
void apply(Editor&, const MoveGrip&);
void apply(Editor&, const Destroy<GripId>&);

}  // namespace iota::edit
