// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// Commands that cut hinges and rigid bodies.
namespace iota::edit {

struct Separate {
  static constexpr std::string_view queued_as = "separate";
  ParticleId p, q;
};
struct SeparatePart {
  static constexpr std::string_view queued_as = "separate";
  BodyId body, part;
};
struct CreateCosmeticBond {
  ParticleId p, q;
};

RestructureReport apply(Editor&, const Separate&);
RestructureReport apply(Editor&, const SeparatePart&);
CosmeticBondId apply(Editor&, const CreateCosmeticBond&);
RestructureReport apply(Editor&, const Destroy<CosmeticBondId>&);

}  // namespace iota::edit
