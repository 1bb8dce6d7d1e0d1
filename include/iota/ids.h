// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace iota {

/// A name for something that a `System` owns: slot + generation, one distinct type per kind.
/// A default-constructed id is null. An id stays valid over snapshot and restore; once its object is gone it is
/// *stale* for ever, since a reused slot gets a new generation.
template <class Kind>
struct Id {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;

  explicit operator bool() const { return generation != 0; }
  friend auto operator<=>(const Id&, const Id&) = default;
};

using BodyId = Id<struct BodyKindTag>;
using ParticleId = Id<struct ParticleKindTag>;  ///< one body's point of a (possibly shared) particle
using BondId = Id<struct BondKindTag>;
using CosmeticBondId = Id<struct CosmeticBondKindTag>;
using EmitterId = Id<struct EmitterKindTag>;
using GripId = Id<struct GripKindTag>;
using ConstraintId = Id<struct ConstraintKindTag>;

}  // namespace iota
