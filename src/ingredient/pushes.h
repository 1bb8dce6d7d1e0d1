// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Forces that were applied to particles for one step.
class Pushes : public NoAnswers {
 public:
  void load(const Model&, const IslandNodes&, double h, Problem&);
  void store(Model&, const IslandNodes&, double h, const Problem&) const;
  bool wakes(const Model&, const IslandNodes&) const;
  bool keeps_awake(const Problem&) const;
};

}  // namespace iota::ingredient
