// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Forces that were applied to particles for one step.
class Pushes : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.pushes.archive(ar, model.rings.slot_count());
  }
  static void validate(const Model&, model::Audit&);
  static void add_loads(const LastStep&, std::uint32_t body, LoadReader&);

  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  bool wakes(const Model&, const IslandNodes&) const;
  bool keeps_awake(const Problem&) const;
};

}  // namespace iota::ingredient
