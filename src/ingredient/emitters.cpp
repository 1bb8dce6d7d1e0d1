// SPDX-License-Identifier: Apache-2.0
#include "ingredient/emitters.h"

#include "ingredient/model.h"
namespace iota::ingredient {

void Emitters::check_links(const Model& model, model::Audit& audit) {
  model.attributes.for_each([&](std::uint32_t slot, const model::Attributes& a) {
    audit.require(a.emitter == none || model.emitters.is_alive(a.emitter), "attributes ", slot, " are of no emitter");
  });
  model.emitters.for_each([&](std::uint32_t slot, const Emitter& e) {
    audit.require(e.key_count <= e.keys.size(), "emitter ", slot, " has ", e.key_count, " keys");
    audit.require(e.rate >= 0 && e.rate <= 1e9 && e.due >= 0 && e.due <= 1, "emitter ", slot, " owes ", e.due,
                  " births, and ", e.rate, " a second");
    audit.require(e.mass > 0 && std::isfinite(e.mass), "emitter ", slot, " gives a mass of ", e.mass);
    audit.require_shape("emitter", slot, e.source);
  });
}

void Emitters::validate(const Model& model, model::Audit& audit) {
  std::vector<std::uint32_t> emitted(model.emitters.slot_count(), 0);
  model.attributes.for_each([&](std::uint32_t slot, const model::Attributes& a) {
    if (a.emitter == none) return;
    ++emitted[a.emitter];
  });
  model.emitters.for_each([&](std::uint32_t slot, const Emitter& e) {
    audit.require(e.alive == emitted[slot], "emitter ", slot, " counts ", e.alive, " particles, has ", emitted[slot]);
  });
}

void Emitters::forget_particle(Model& model, std::uint32_t particle) {
  const std::uint32_t slot = model.particles[particle].attributes;
  if (slot == none) return;
  if (const std::uint32_t emitter = model.attributes[slot].emitter; emitter != none) --model.emitters[emitter].alive;
}

model::ChangedSlots* Emitters::scene_log(Model& model) { return &model.changed_emitters; }

void Emitters::describe(const SceneView& view, SceneChanges& changes) {
  const Model& model = view.model;
  const auto none_of = [](std::uint32_t, std::vector<std::uint32_t>&) {};
  for (const std::uint32_t slot : view.slots(model.emitters, model.changed_emitters, none_of)) {
    if (model.emitters.is_alive(slot))
      changes.particle_sets.set.push_back({slot, model.emitters[slot].active != 0, model.emitters[slot].max_count});
    else
      changes.particle_sets.gone.push_back(slot);
  }
}

}  // namespace iota::ingredient
