// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// The laws of force that bonds and pairs share.
class Laws : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.laws.archive(ar);
    if constexpr (std::is_same_v<Archive, Reader>) model.compile_laws();
  }
};

}  // namespace iota::ingredient
