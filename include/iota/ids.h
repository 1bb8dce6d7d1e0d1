// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace iota {

/// The word of a kind in error texts, as an argument of a template.
template <std::size_t size>
struct KindName {
  char text[size];
  consteval KindName(const char (&word)[size]) { std::copy_n(word, size, text); }  // implicit: Id<"body">
};

/// Identifies an object of a `System`: slot + generation, one distinct type per kind. A default-constructed id is null.
/// An id stays valid over snapshot and restore; once its object is destroyed it is *stale* for ever, since a reused slot
/// gets a new generation.
template <KindName kind>
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

using BodyId = Id<"body">;
using ParticleId = Id<"particle">;  ///< one body's point of a (possibly shared) particle
using BondId = Id<"bond">;
using CosmeticBondId = Id<"cosmetic bond">;
using EmitterId = Id<"emitter">;
using GripId = Id<"grip">;
using ConstraintId = Id<"constraint">;
using LawId = Id<"law">;
using FieldId = Id<"field">;
using PairsId = Id<"pairwise force">;
using GroupId = Id<"group">;

}  // namespace iota
