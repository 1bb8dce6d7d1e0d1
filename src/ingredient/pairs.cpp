// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pairs.h"

#include <cmath>

namespace iota::ingredient {

void Pairs::validate(const Model& model, model::Audit& audit) {
  model.pairs.for_each([&](std::uint32_t slot, const model::Pairs& p) {
    audit.use_law("pairwise force", slot, p.law);
    audit.require_group("pairwise force", slot, p.group);
    audit.require(p.cutoff > 0 && std::isfinite(p.cutoff), "pairwise force ", slot, " has cut-off ", p.cutoff);
  });
}

}  // namespace iota::ingredient
