// SPDX-License-Identifier: Apache-2.0
#include "read/attributes.h"

#include "base/text.h"

#include <stdexcept>

namespace iota::read {

ParticleAttributes attributes(const model::Model& model, const model::Attributes& a) {
  return ingredient::Emitters::look(model, a);
}

const model::Attributes* find_attributes(const model::Model& model, std::uint32_t particle) {
  const std::uint32_t slot = model.particles[particle].attributes;
  return slot == model::none ? nullptr : &model.attributes[slot];
}

const model::Attributes& oriented_attributes(const model::Model& model, std::uint32_t particle) {
  const model::Attributes* a = find_attributes(model, particle);
  if (!a || !a->oriented) throw std::invalid_argument(text("particle ", particle, " has no orientation of its own"));
  return *a;
}

}  // namespace iota::read
