// SPDX-License-Identifier: Apache-2.0
#include "ingredient/tables.h"

#include "ingredient/model.h"

namespace iota::ingredient {

std::vector<std::string> validate(const model::Model& model) {
  model::Audit audit(model);
  audit.require(model.mode <= IntegrationMode::accurate, "the integration mode is number ", int(model.mode));
  audit.require(model.tolerance >= 1e-12 && model.tolerance <= 1, "the tolerance is ", model.tolerance);
  audit.require(model.budget_iterations >= 0 && model.budget_seconds >= 0 && model.budget_contacts >= 0,
                "the budget of a step is negative");
  audit.require(model.contacts_share > 0 && model.contacts_share <= 1, "the share of contacts is ",
                model.contacts_share);
  audit.require_text("solver", 0, model.solver);
  audit.check_links();
  for_each_type<Ingredients>([&]<class I>() { I::check_links(model, audit); });
  if (!audit.is_good()) return std::move(audit).complaints();
  audit.check_structure();
  for_each_type<Ingredients>([&]<class I>() { I::validate(model, audit); });
  audit.check_counts();
  return std::move(audit).complaints();
}

}  // namespace iota::ingredient
