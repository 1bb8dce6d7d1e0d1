// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

#include <array>

namespace iota::ingredient {

/// Names of bodies. They have no effect in a step.
class Names : public NoAnswers {
 public:
  using Name = std::array<char, 64>;  ///< ended by zeros
  struct Tables {
    SideTable<Name> names;  ///< of bodies

    template <class Archive>
    void archive(Archive& ar, const Structure& structure) {
      names.archive(ar, structure.bodies.slot_count());
    }
  };
  static void validate(const Model&, model::Audit&);
  static void check_links(const Model&, model::Audit&);
  static void forget_body(Model&, std::uint32_t body);
};

}  // namespace iota::ingredient
