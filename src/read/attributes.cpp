// SPDX-License-Identifier: Apache-2.0
#include "read/attributes.h"

#include "base/text.h"

#include <algorithm>
#include <stdexcept>

namespace iota::read {

namespace {

/// Radius and color on an emitter's curve. life: 0 birth, 1 death.
void look_at(const ingredient::Emitter& emitter, double life, ParticleAttributes& out) {
  if (emitter.key_count == 0) return;
  std::uint32_t next = 0;
  while (next < emitter.key_count && emitter.keys[next].life < life) ++next;
  const AttributeKey& b = emitter.keys[std::min(next, emitter.key_count - 1)];
  const AttributeKey& a = emitter.keys[next > 0 ? next - 1 : 0];
  const double t = b.life > a.life ? std::clamp((life - a.life) / (b.life - a.life), 0.0, 1.0) : 1;
  out.radius = a.radius + t * (b.radius - a.radius);
  for (std::size_t i = 0; i < 4; ++i) out.color[i] = static_cast<float>(a.color[i] + t * (b.color[i] - a.color[i]));
}

}  // namespace

ParticleAttributes attributes(const model::Model& model, const model::Attributes& a) {
  ParticleAttributes value{a.age, a.lifetime, a.radius, a.color};
  if (a.emitter != model::none) look_at(model.emitters[a.emitter], a.age / a.lifetime, value);
  return value;
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
