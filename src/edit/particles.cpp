// SPDX-License-Identifier: Apache-2.0
#include "edit/particles.h"

#include "edit/bodies.h"
#include "edit/constraints.h"
#include "edit/nails.h"
#include "ingredient/attachments.h"
#include "math/checks.h"
#include "model/restructure.h"

#include <array>

namespace iota::edit {

namespace {

ParticleId make_marker(Editor& e, std::uint32_t body, const Vec3& position) {
  model::Model& model = e.model;
  if (!model.spans(body, position))
    throw std::invalid_argument(text("a massless particle is carried by the massive ones of its body; those of body ",
                                     body, model.bodies[body].rank == 0 ? " are yet to be made" : " do not reach ",
                                     model.bodies[body].rank == 0 ? "" : text_of(position)));
  const std::uint32_t marker = model.make_marker(body, position);
  model.particles[marker].part = model.part_at(body, position);
  e.structure_changed();
  return model.particles.id(marker);
}

/// A solid loses its shape when one of its points is moved.
void end_solids_of(model::Model& model, std::uint32_t body, std::uint32_t point) {
  const std::uint32_t before = model.solids.size();
  model.remove_solids_of(body, point);
  if (model.solids.size() < before)
    model.notes.push_back(text("body ", body, " is not the solid any more that it was given as: particle ", point,
                               ", one of its four points, was moved; set_pose moves a body as it is"));
}

}  // namespace

ParticleId apply(Editor& e, const CreateParticle& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  refuse_obstacle(model, body, "have particles");
  require_finite("position", c.position);
  require_finite("velocity", c.velocity);
  require_own_motion(model.bodies[body].kind, "velocity", c.velocity);
  if (c.mass == 0) return make_marker(e, body, c.position);
  require_mass("mass", c.mass);
  const std::uint32_t before = model.bodies[body].count;
  const std::uint32_t particle = model.make_particle(body, c.position, c.mass, c.velocity);
  // Rebuilt for each of n particles, the basis costs n^2: eight minutes for a molecule of 100 000 atoms.
  if (keeps_basis(model, body) && carry_by_basis(model, body, before, std::array{particle}))
    model.keep_inertia_positive(body);
  else
    model.rebuild_basis(body);
  model.mark_body(body);
  e.mark_velocity_dirty(particle);
  e.structure_changed();
  return model.particles.id(particle);
}

void apply(Editor& e, const SetPosition& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  require_finite("position", c.value);
  if (model.bodies[model.particles[particle].body].kind == BodyKind::scripted) return carry(e, c.particle, c.value);
  const std::uint32_t ring = model.particles[particle].ring;
  model.for_each_in_ring(ring, [&](std::uint32_t p) {
    if (model.particles[p].is_marker() && !model.spans(model.particles[p].body, c.value))
      throw std::invalid_argument(text("particle ", p, " is massless, and the massive ones of its body do not reach ",
                                       text_of(c.value), "; move those"));
  });
  model::Ring& r = model.rings[ring];
  r.position = c.value;
  if (r.nailed) model.nails.at(ring).position = model.nails.at(ring).position_before = c.value;
  model.for_each_in_ring(ring, [&](std::uint32_t moved) {
    const std::uint32_t body = model.particles[moved].body;
    model.for_each_particle_of(body, [&](std::uint32_t p) {  // markers follow the basis
      if (!model.particles[p].is_marker() || p == moved || model.is_unknown(model.particles[p])) return;
      model.rings[model.particles[p].ring].position = model.carried(p).first;
    });
    if (!model.particles[moved].is_marker()) end_solids_of(model, body, moved);
    model.rebuild_basis(body);
    model.mark_body(body);
  });
  model.for_each_in_ring(ring, [&](std::uint32_t p) { refresh_coordinates_of(e, model.particles[p].body); });
  e.mark_velocity_dirty(particle);
}

void apply(Editor& e, const SetVelocity& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  require_finite("velocity", c.value);
  require_own_motion(model.bodies[model.particles[particle].body].kind, "velocity", c.value);
  model.rings[model.particles[particle].ring].velocity = c.value;
  e.mark_velocity_dirty(particle);
}

void apply(Editor& e, const SetMass& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  require_mass("mass", c.value);
  const std::uint32_t body = model.particles[particle].body;
  model.particles[particle].mass = model.particles[particle].inactive ? c.value * model::inactive_share : c.value;
  const bool was_rod = model.bodies[body].first_inertia != model::none;
  model.keep_inertia_positive(body);
  if (was_rod && model.bodies[body].first_inertia == model::none)
    model.notes.push_back(text("body ", body, " is not a rod any more, and has no spin about its axis: particle ",
                               particle, " has too little mass for the inertia of one; set_rod gives it anew"));
  model.mark_body(body);
}

void apply(Editor& e, const ApplyForce& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  require_finite("force", c.value);
  model.pushes.make(model.particles[particle].ring).force += c.value;
  ingredient::Strides::disturb(model, model.particles[particle].body);
}

void apply(Editor& e, const SetParticleActive& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.particle);
  model::Particle& p = model.particles[slot];
  if (p.inactive != static_cast<std::uint8_t>(c.active)) return;
  p.inactive = !c.active;
  p.mass *= c.active ? 1 / model::inactive_share : model::inactive_share;
  model.acting_changed(slot);
  model.bonds.for_each_of(slot, [&](std::uint32_t b) {
    for (const std::uint32_t end : {model.bonds[b].p, model.bonds[b].q}) model.mark_particle(end);
  });
  model.mark_particle(slot);
  e.structure_changed();
}

void apply(Editor& e, const SetParticleBreakForce& c) {
  const std::uint32_t particle = e.require(c.particle);
  require_break_force(c.force);
  e.model.set_fuse(particle, c.force);
}

void apply(Editor& e, const Destroy<ParticleId>& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.id);
  const ingredient::Attachments attachments(model, {{model.particles[particle].body}});
  destroy_particle(model, particle);
  attachments.reattach(model);
  e.structure_changed();
}

}  // namespace iota::edit
