// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/emitters.h>

namespace iota::edit {

struct CreateEmitter {
  EmitterOptions options;
};
struct SetEmitterActive {
  static constexpr std::string_view queued_as = "set_active";
  EmitterId emitter;
  bool active;
};
struct SetRate {
  EmitterId emitter;
  double per_second;
};
struct MoveEmitter {
  EmitterId emitter;
  Vec3 position;
  Quaternion orientation;
};

EmitterId apply(Editor&, const CreateEmitter&);
void apply(Editor&, const SetEmitterActive&);
void apply(Editor&, const SetRate&);
void apply(Editor&, const MoveEmitter&);
void apply(Editor&, const Destroy<EmitterId>&);

}  // namespace iota::edit
