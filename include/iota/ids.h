// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <stdexcept>

namespace iota {

/// Identifies an object of a `System`: slot + generation, one distinct type per kind.
/// A default-constructed id is null. An id stays valid over snapshot and restore; once its object is destroyed it is
/// *stale* for ever, since a reused slot gets a new generation.
template <class Kind>
struct Id {
  std::uint32_t slot = 0;
  std::uint32_t generation = 0;

  explicit operator bool() const { return generation != 0; }
  friend auto operator<=>(const Id&, const Id&) = default;
};

/// The object of an id no longer exists; the text says what became of it.
struct StaleIdError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

using BodyId = Id<struct BodyKindTag>;
using ParticleId = Id<struct ParticleKindTag>;  ///< one body's point of a (possibly shared) particle
using BondId = Id<struct BondKindTag>;
using CosmeticBondId = Id<struct CosmeticBondKindTag>;
using EmitterId = Id<struct EmitterKindTag>;
using GripId = Id<struct GripKindTag>;
using ConstraintId = Id<struct ConstraintKindTag>;

}  // namespace iota
