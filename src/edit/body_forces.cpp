// SPDX-License-Identifier: Apache-2.0
#include "edit/body_forces.h"

#include "edit/law_checks.h"
#include "edit/particles.h"
#include "math/checks.h"
#include "math/mat3.h"

namespace iota::edit {

void spread(const model::Model& model, std::uint32_t body, const Vec3& force,
            std::vector<std::pair<ParticleId, Vec3>>& forces) {
  const double mass = model.body_mass(body);
  if (!(mass > 0)) throw std::invalid_argument(text("body ", body, " has no particles that a force could act on"));
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (!model.particles[p].is_marker())
      forces.emplace_back(model.particles.id(p), (model.particles[p].mass / mass) * force);
  });
}

void apply(Editor& e, const SetBodyName& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  ingredient::Names::Name name{};
  put_text(name, c.value, "the name of a body");
  if (c.value.empty())
    model.names.erase(body);
  else
    model.names.make(body) = name;
  model.note_body(body);
}

void check(const Editor& e, const SetBodyMass& c) {
  const model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_mass("mass", c.value);
  const double before = model.body_mass(body);
  if (!(before > 0)) throw std::invalid_argument(text("body ", body, " has no particles to have a mass"));
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (!model.particles[p].is_marker() && !model.particles[p].inactive)
      require_mass("the mass of each particle", c.value / before * model.particles[p].mass);
  });
}

void apply(Editor& e, const SetBodyMass& c) {
  check(e, c);
  model::Model& model = e.model;
  const std::uint32_t body = c.body.slot;
  const double factor = c.value / model.body_mass(body);
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.particles[p].mass *= factor;
    model.for_each_twin_of(p, [&](std::uint32_t twin) { model.twins[twin].mass *= factor; });
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) { model.inertia_pairs[i].inertia *= factor; });
  if (auto* const spin = model.spins.find(body)) spin->momentum *= factor;
  model.mark_body(body);
}

// A force and a moment about the center, which do not change while the body turns in the step.
void apply(Editor& e, const ApplyBodyForce& c) {
  const std::uint32_t body = e.require(c.body);
  require_finite("force", c.force);
  if (!c.at_center) {
    require_finite("at", c.at);
    const Vec3 moment = cross(c.at - e.model.center_of_mass(body), c.force);
    ingredient::Pushes::check_torque(e.model, body, moment);
    ingredient::Pushes::add_torque(e.model, body, moment);
  }
  std::vector<std::pair<ParticleId, Vec3>> forces;
  spread(e.model, body, c.force, forces);
  for (const auto& [particle, share] : forces) apply(e, ApplyForce{particle, share});
}

void apply(Editor& e, const ApplyBodyTorque& c) {
  const std::uint32_t body = e.require(c.body);
  require_finite("torque", c.value);
  ingredient::Pushes::check_torque(e.model, body, c.value);
  ingredient::Pushes::add_torque(e.model, body, c.value);
  ingredient::Strides::disturb(e.model, body);
}

}  // namespace iota::edit
