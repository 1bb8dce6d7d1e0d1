// SPDX-License-Identifier: Apache-2.0
#include "ingredient/tables.h"

#include "ingredient/model.h"
namespace iota::ingredient {

std::vector<std::string> validate(const model::Model& model) {
  model::Audit audit(model);
  audit.check_structure();
  for_each_type<Ingredients>([&]<class I>() { I::validate(model, audit); });
  audit.check_counts();
  return std::move(audit).complaints();
}

}  // namespace iota::ingredient
