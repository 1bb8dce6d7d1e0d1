// SPDX-License-Identifier: Apache-2.0
#include "edit/emitters.h"

#include "math/checks.h"
#include "read/attributes.h"
#include "shape/shape.h"

namespace iota::edit {

namespace {

void require_rate(double rate) {
  require_not_negative("rate", rate);
  if (rate > 1e9) throw std::invalid_argument(text("rate must be at most 1e9 births a second, got ", rate));
}

}  // namespace

EmitterId apply(Editor& editor, const CreateEmitter& c) {
  const EmitterOptions& o = c.options;
  shape::check(o.source);
  if (!shape::is_source(o.source))
    throw std::invalid_argument(text("particles cannot be born in a ", shape::name(o.source)));
  require_rate(o.rate);
  require_finite("position", o.position);
  require_finite("velocity", o.velocity);
  require_not_negative("velocity_spread", o.velocity_spread);
  require_finite("velocity_spread", {o.velocity_spread, 0, 0});
  require_positive("lifetime", o.lifetime);
  require_not_negative("lifetime_spread", o.lifetime_spread);
  if (!(o.lifetime_spread < o.lifetime))
    throw std::invalid_argument(
        text("lifetime_spread (", o.lifetime_spread, " s) must be below the lifetime (", o.lifetime, " s)"));
  require_mass("mass", o.mass);
  require_not_negative("damping", o.damping);
  ingredient::Emitter e;
  if (o.curve.size() > e.keys.size())
    throw std::invalid_argument(
        text("the curve of an emitter has at most ", e.keys.size(), " keys, got ", o.curve.size()));
  for (std::size_t i = 0; i < o.curve.size(); ++i) {
    if (!(o.curve[i].life >= (i > 0 ? o.curve[i - 1].life : 0) && o.curve[i].life <= 1))
      throw std::invalid_argument("the keys of a curve must come by rising life, from 0 to 1");
    require_not_negative("radius", o.curve[i].radius);
    require_color(o.curve[i].color);
    e.keys[i] = o.curve[i];
  }
  e.source = shape::to_data(o.source);
  e.rate = o.rate, e.position = o.position, e.velocity = o.velocity;
  e.orientation = require_quaternion("orientation", o.orientation);
  e.velocity_spread = o.velocity_spread, e.lifetime = o.lifetime, e.lifetime_spread = o.lifetime_spread;
  e.mass = o.mass, e.damping = o.damping, e.max_count = o.max_count, e.seed = o.seed;
  e.key_count = static_cast<std::uint32_t>(o.curve.size());
  const EmitterId emitter = editor.model.emitters.create(e);
  editor.model.changed_emitters.note(emitter.slot);
  return emitter;
}

void apply(Editor& e, const SetEmitterActive& c) {
  const std::uint32_t slot = e.require(c.emitter);
  e.model.emitters[slot].active = c.active;
  e.model.changed_emitters.note(slot);
}

void apply(Editor& e, const SetRate& c) {
  const std::uint32_t slot = e.require(c.emitter);
  require_rate(c.per_second);
  e.model.emitters[slot].rate = c.per_second;
}

void apply(Editor& e, const MoveEmitter& c) {
  ingredient::Emitter& emitter = e.model.emitters[e.require(c.emitter)];
  require_finite("position", c.position);
  emitter.orientation = require_quaternion("orientation", c.orientation);
  emitter.position = c.position;
}

void apply(Editor& e, const Destroy<EmitterId>& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.id);
  model.attributes.for_each([&](std::uint32_t, model::Attributes& a) {
    if (a.emitter != slot) return;
    const ParticleAttributes look = read::attributes(model, a);  // they keep their present look
    a.radius = look.radius, a.color = look.color, a.emitter = model::none;
    model.note_body(model.particles[a.particle].body);
  });
  model.emitters.destroy(slot);
  model.changed_emitters.note(slot);
  e.structure_changed();
}

}  // namespace iota::edit
