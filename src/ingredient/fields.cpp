// SPDX-License-Identifier: Apache-2.0
#include "ingredient/fields.h"

namespace iota::ingredient {

void Fields::validate(const Model& model, model::Audit& audit) {
  model.fields.for_each(
      [&](std::uint32_t slot, const model::Field& f) { audit.require_group("field", slot, f.group); });
}

}  // namespace iota::ingredient
