// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// Commands that hinge particles and make rigid bodies of several.
namespace iota::edit {

struct CombineParticles {
  static constexpr std::string_view queued_as = "combine";
  ParticleId p, q;
  double over;
};
struct CombineBodies {
  static constexpr std::string_view queued_as = "combine";
  BodyId a, b;
};

RestructureReport apply(Editor&, const CombineParticles&);
RestructureReport apply(Editor&, const CombineBodies&);

/// Ends a closing before its particles have met.
RestructureReport call_off(Editor&, std::uint32_t closing);

}  // namespace iota::edit
