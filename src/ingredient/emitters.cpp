// SPDX-License-Identifier: Apache-2.0
#include "ingredient/emitters.h"

namespace iota::ingredient {

void Emitters::validate(const Model& model, model::Audit& audit) {
  std::vector<std::uint32_t> emitted(model.emitters.slot_count(), 0);
  model.attributes.for_each([&](std::uint32_t slot, const model::Attributes& a) {
    if (a.emitter == none) return;
    audit.require(model.emitters.is_alive(a.emitter), "attributes ", slot, " are of no emitter");
    if (model.emitters.is_alive(a.emitter)) ++emitted[a.emitter];
  });
  model.emitters.for_each([&](std::uint32_t slot, const model::Emitter& e) {
    audit.require(e.alive == emitted[slot], "emitter ", slot, " counts ", e.alive, " particles, has ", emitted[slot]);
  });
}

}  // namespace iota::ingredient
