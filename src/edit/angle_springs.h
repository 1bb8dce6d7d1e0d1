// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/angle_springs.h>

namespace iota::edit {

struct CreateAngleSpring {
  ParticleId p, middle, q;
  AngleSpringOptions options;
};
struct SetAngleSpring {
  AngleSpringId spring;
  AngleSpringOptions options;
};

AngleSpringId apply(Editor&, const CreateAngleSpring&);
void apply(Editor&, const SetAngleSpring&);
void apply(Editor&, const Destroy<AngleSpringId>&);

}  // namespace iota::edit
