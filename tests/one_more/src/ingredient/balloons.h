// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

struct Balloon {
  Vec3 lift;  ///< N
};

/// Constant forces on rings.
class Balloons : public NoAnswers {
 public:
  struct Tables {
    SideTable<Balloon> balloons;  ///< of rings

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      balloons.archive(ar, structure.rings.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void add_energy(const Scope&, Energies&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static bool holds(const Model&, std::uint32_t particle);
  static void ring_changed(Model&, std::uint32_t ring);
  static void ring_merged(Model&, std::uint32_t into, std::uint32_t from, bool replaces);

  void load(const Model&, const IslandNodes&, double h, Problem&);
};

}  // namespace iota::ingredient
