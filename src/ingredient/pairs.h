// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "laws/pair_law.h"

namespace iota::ingredient {

/// A force between all pairs of a group that are nearer than a cut-off.
struct PairForce {
  std::uint32_t law = none;
  std::uint32_t group = none;  ///< none: all particles
  std::uint32_t other = none;  ///< only pairs between `group` and this group; none: within `group`
  std::uint8_t active = 1, shifted = 0;
  std::array<std::uint8_t, 2> padding{};
  double cutoff = 1;  ///< m
  std::array<double, laws::max_parameters> parameters{};
};

/// Forces between all near pairs of a group of particles, evaluated once a step and held.
class Pairs : public NoAnswers {
 public:
  struct Tables {
    SlotTable<PairForce, PairsId> pairs;

    const auto& table_of(PairsId) const { return pairs; }
    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      pairs.archive(ar);
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
};

}  // namespace iota::ingredient
