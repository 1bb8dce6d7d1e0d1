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

/// Moves a particle of a scripted body, and what is hinged to it: it arrives at the end of the next step.
void carry(Editor&, ParticleId, const Vec3& position);
/// Ends what `carry` did to the particles of a body that is not scripted any more; nails stay.
void stop_carrying(Editor&, std::uint32_t body);

}  // namespace iota::edit
