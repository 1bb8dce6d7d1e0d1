// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient_list.h"

#include <string>
#include <vector>

namespace iota::ingredient {

/// All of a model that is saved, to and from bytes.
template <class Archive>
void archive(model::Model& model, Archive& ar) {
  model.archive(ar);
  for_each_type<Ingredients>([&]<class I>() { I::archive(model, ar); });
}

/// What is wrong with a model; empty: nothing.
std::vector<std::string> validate(const model::Model&);

}  // namespace iota::ingredient
