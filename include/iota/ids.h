// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <stdexcept>

namespace iota {

/// Identifies an object of a `System`: slot + generation, one distinct type per kind.
/// `Kind::name` is the kind's word in error texts. A default-constructed id is null. An id stays valid over snapshot and
/// restore; once its object is destroyed it is *stale* for ever, since a reused slot gets a new generation.
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

struct BodyTag {
  static constexpr const char* name = "body";
};
using BodyId = Id<BodyTag>;
struct ParticleTag {
  static constexpr const char* name = "particle";
};
using ParticleId = Id<ParticleTag>;  ///< one body's point of a (possibly shared) particle
struct BondTag {
  static constexpr const char* name = "bond";
};
using BondId = Id<BondTag>;
struct CosmeticBondTag {
  static constexpr const char* name = "cosmetic bond";
};
using CosmeticBondId = Id<CosmeticBondTag>;
struct AngleSpringTag {
  static constexpr const char* name = "angle spring";
};
using AngleSpringId = Id<AngleSpringTag>;
struct EmitterTag {
  static constexpr const char* name = "emitter";
};
using EmitterId = Id<EmitterTag>;
struct GripTag {
  static constexpr const char* name = "grip";
};
using GripId = Id<GripTag>;
struct ConstraintTag {
  static constexpr const char* name = "constraint";
};
using ConstraintId = Id<ConstraintTag>;

}  // namespace iota
