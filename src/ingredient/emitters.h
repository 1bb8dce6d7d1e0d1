// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Sources of particles; what they emit is born and dies between steps, see `particle_life`.
class Emitters : public NoAnswers {
 public:
  template <class Archive>
  static void archive(Model& model, Archive& ar) {
    model.emitters.archive(ar);
  }
  static void validate(const Model&, model::Audit&);
};

}  // namespace iota::ingredient
