// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::edit {

struct Nail {
  static constexpr std::string_view queued_as = "nail";
  ParticleId particle;
  bool in_place;
  Vec3 position;
};
struct Release {
  static constexpr std::string_view queued_as = "release";
  ParticleId particle;
};

void apply(Editor&, const Nail&);
void apply(Editor&, const Release&);

}  // namespace iota::edit
