// SPDX-License-Identifier: Apache-2.0
#include "ingredient/names.h"

#include "ingredient/model.h"

namespace iota::ingredient {

void Names::check_links(const Model& model, model::Audit& audit) {
  model.names.for_each([&](std::uint32_t body, const Name& name) { audit.require_text("body", body, name); });
}

void Names::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a name", model.names, model.bodies);
}

void Names::forget_body(Model& model, std::uint32_t body) { model.names.erase(body); }

}  // namespace iota::ingredient
