// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace iota::soak {

struct EditCount {
  std::uint64_t edits = 0, refused = 0, most_bodies = 0;
  std::uint64_t joined = 0, cut = 0;  ///< edits after which there were fewer, or more, articulates
};

/// Makes `count` random edits of the structure of a model (combine, separate, weld, destroy, create, bonds), without physics,
/// and the same edits of a twin that has only labels: the body and the ring of each particle, and its mass.
/// After each edit both must agree on bodies, rings, articulates (the twin floods the whole graph), masses, bonds and
/// refusals; every 64th time the model is validated. Returns the first difference, with the edits before it.
std::optional<std::string> compare_edits(std::uint64_t seed, std::uint64_t count, EditCount& counted);

}  // namespace iota::soak
