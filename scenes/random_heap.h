// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

/// Random heaps: bodies of all kinds that fall on each other, are thrown and shot, combined, separated, hinged, held and
/// destroyed while they touch, in all modes, steps and budgets. All is measured from outside.
namespace iota::scenes {

/// What many heaps led to. Energies: gained by a step without an edit, beyond the work of what is held and scripted, as a
/// share of the energy of the heap.
struct HeapTally {
  std::uint64_t heaps = 0, steps = 0, edits = 0, refused = 0, unsolved = 0, approximate = 0;
  double gained = 0;            ///< by steps that were solved
  double gained_in_sweeps = 0;  ///< by steps solved contact by contact
  double gained_unsolved = 0;
};

/// Plays a heap of 120 steps. Returns what is wrong with it, in a sentence.
std::optional<std::string> play_heap(std::uint64_t seed, HeapTally&);

}  // namespace iota::scenes
