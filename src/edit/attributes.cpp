// SPDX-License-Identifier: Apache-2.0
#include "edit/attributes.h"

#include "math/checks.h"

namespace iota::edit {

using model::none;

namespace {

model::Attributes& attributes_of(Editor& e, std::uint32_t particle) {
  model::Model& model = e.model;
  std::uint32_t& slot = model.particles[particle].attributes;
  if (slot == none) {
    model::Attributes a;
    a.particle = particle;
    slot = model.attributes.create(a).slot;
  }
  return model.attributes[slot];
}

model::Attributes& require_oriented(Editor& e, ParticleId id, std::string_view what) {
  model::Model& model = e.model;
  const std::uint32_t slot = model.particles[e.require(id)].attributes;
  if (slot == none || !model.attributes[slot].oriented)
    throw std::invalid_argument(
        text(what, " needs an oriented particle; give particle ", id.slot, " an orientation first"));
  return model.attributes[slot];
}

}  // namespace

void apply(Editor& e, const SetAttributes& c) {
  const std::uint32_t particle = e.require(c.particle);
  require_not_negative("age", c.value.age);
  if (!(c.value.lifetime > 0)) throw std::invalid_argument(text("lifetime must be above 0 s, got ", c.value.lifetime));
  require_not_negative("radius", c.value.radius);
  require_color(c.value.color);
  model::Attributes& a = attributes_of(e, particle);
  const std::uint32_t body = e.model.particles[particle].body;
  if (c.value.radius != a.radius && e.model.material(body)) ingredient::Contacts::wake(e.model, body);
  a.age = c.value.age, a.lifetime = c.value.lifetime, a.radius = c.value.radius, a.color = c.value.color;
  e.model.note_body(body);
}

void apply(Editor& e, const SetOrientation& c) {
  const std::uint32_t particle = e.require(c.particle);
  const Quaternion orientation = require_quaternion("orientation", c.value);
  model::Attributes& a = attributes_of(e, particle);
  if (!a.oriented) {
    a.oriented = 1;
    ++e.model.members_revision;
    const double r = a.radius > 0 ? a.radius : 0.05;  // a ball's
    a.moment = 0.4 * e.model.particles[particle].mass * r * r;
    if (!(a.moment > 0)) a.moment = 1e-6;
  }
  a.orientation = orientation;
}

void apply(Editor& e, const SetSpin& c) {
  require_finite("spin", c.value);
  require_oriented(e, c.particle, "spin").spin = c.value;
}

void apply(Editor& e, const ApplyTorque& c) {
  require_finite("torque", c.value);
  require_oriented(e, c.particle, "a torque").torque += c.value;
}

void apply(Editor& e, const SetMoment& c) {
  require_positive("moment", c.value);
  require_oriented(e, c.particle, "moment").moment = c.value;
}

void apply(Editor& e, const SetSpinDamping& c) {
  require_not_negative("damping", c.per_second);
  require_oriented(e, c.particle, "spin damping").damping = c.per_second;
}

void apply(Editor& e, const Align& c) {
  require_finite("direction", c.direction);
  require_not_negative("stiffness", c.stiffness);
  require_not_negative("damping", c.damping);
  const double length = norm(c.direction);
  require_positive("the length of the preferred direction", length);
  model::Attributes& a = require_oriented(e, c.particle, "a preferred direction");
  a.preferred = (1 / length) * c.direction, a.stiffness = c.stiffness, a.alignment_damping = c.damping;
}

}  // namespace iota::edit
