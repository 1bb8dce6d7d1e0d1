// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

namespace iota::ingredient {

/// Bonds that are solved implicitly, with the positions at the end of the step: springs, drags and any other law.
class ImplicitBonds : public NoAnswers {
 public:
  void build(const IslandMap&, Problem&);
  void load(const Model&, const IslandNodes&, double h, Problem&);

 private:
  std::vector<std::uint32_t> springs_, drags_, radials_;  // bonds of the forces of each type
};

}  // namespace iota::ingredient
