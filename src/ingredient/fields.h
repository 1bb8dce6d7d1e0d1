// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Forces on each particle by itself; they are taken once a step and held.
class Fields : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.fields.archive(ar);
    if constexpr (std::is_same_v<Archive, Reader>) model.compile_fields();
  }
  static void validate(const Model&, model::Audit&);
};

}  // namespace iota::ingredient
