// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pairs.h"

#include <cmath>
#include "ingredient/model.h"

namespace iota::ingredient {

void Pairs::check_links(const Model& model, model::Audit& audit) {
  model.pairs.for_each([&](std::uint32_t slot, const PairForce& p) {
    audit.require(model.laws.is_alive(p.law) && model.laws[p.law].has_derivative(), "pairwise force ", slot,
                  " has no living law with a derivative");
  });
}

void Pairs::validate(const Model& model, model::Audit& audit) {
  model.pairs.for_each([&](std::uint32_t slot, const PairForce& p) {
    audit.use("law", p.law);
    audit.require_group("pairwise force", slot, p.group);
    audit.require_group("pairwise force", slot, p.other);
    audit.require(p.cutoff > 0 && std::isfinite(p.cutoff), "pairwise force ", slot, " has cut-off ", p.cutoff);
  });
}

}  // namespace iota::ingredient
