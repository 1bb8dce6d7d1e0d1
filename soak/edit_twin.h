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
/// and the same edits of a twin that knows nothing but labels: which body and which ring each particle is in, and its mass.
/// After each edit both must agree on bodies, rings, articulates (the twin floods the whole graph), masses, bonds and on
/// what is refused; every 64th time the model validates itself. Returns the first disagreement, with what led there.
std::optional<std::string> compare_edits(std::uint64_t seed, std::uint64_t count, EditCount& counted);

}  // namespace iota::soak
