// SPDX-License-Identifier: Apache-2.0
#include "ingredient/outcome.h"

#include "ingredient/ingredient_list.h"
#include "ingredient/model.h"

namespace iota::ingredient {

void end_step(model::Model& model, double h) { end_step<Ingredients>(model, h); }

void tell(model::Model& model, Outcome& outcome) {
  outcome.clear();
  tell<Ingredients>(model, outcome);
}

}  // namespace iota::ingredient
