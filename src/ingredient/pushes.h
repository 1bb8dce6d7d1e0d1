// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Forces that were applied to a ring, N.
struct Push {
  Vec3 force;   ///< for the next step only
  Vec3 before;  ///< in the last step
};

/// Forces that were applied to particles for one step.
class Pushes : public NoAnswers {
 public:
  struct Tables {
    SideTable<Push> pushes;  ///< of rings

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      pushes.archive(ar, structure.rings.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void ring_changed(Model&, std::uint32_t ring);
  static void ring_merged(Model&, std::uint32_t into, std::uint32_t from, bool replaces);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);
  static void end_step(Model&, double h);

  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  static void visit_stirred(const Model&, double h, Visit);
  bool keeps_awake(const Model&, const Problem&) const;
};

}  // namespace iota::ingredient
