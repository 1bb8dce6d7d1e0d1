// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Forces between all pairs of a group of particles that are near each other; they are taken once a step and held.
class Pairs : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.pairs.archive(ar);
  }
  static void validate(const Model&, model::Audit&);
};

}  // namespace iota::ingredient
