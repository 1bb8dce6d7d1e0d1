// SPDX-License-Identifier: Apache-2.0
#include "ingredient/loads.h"
#include "model/nailed.h"
#include "read/attributes.h"
#include "system/core.h"

#include <limits>

namespace iota {

void Particles::set_break_force(ParticleId id, double force) { core_.execute(edit::SetParticleBreakForce{id, force}); }

double Particles::break_force(ParticleId id) const {
  const model::Model& m = core_.model;
  const double* const force = m.fuses.find(core_.slot(id));
  return force ? *force : std::numeric_limits<double>::infinity();
}

Vec3 Particles::hinge_force(ParticleId id) const { return ingredient::calc_hinge_force(core_.model, core_.slot(id)); }

bool Particles::is_active(ParticleId id) const { return !core_.model.particles[core_.slot(id)].inactive; }

void Particles::set_active(ParticleId id, bool active) { core_.execute(edit::SetParticleActive{id, active}); }

Vec3 Particles::net_force(ParticleId id) const {
  const model::Particle& p = core_.model.particles[core_.slot(id)];
  return p.mass * core_.model.rings[p.ring].acceleration;
}

ParticleAttributes Particles::attributes(ParticleId id) const {
  const model::Model& m = core_.model;
  const model::Attributes* a = read::find_attributes(m, core_.slot(id));
  return a ? read::attributes(m, *a) : ParticleAttributes{};
}

bool Particles::has_attributes(ParticleId id) const {
  return core_.model.particles[core_.slot(id)].attributes != model::none;
}

void Particles::set_attributes(ParticleId id, const ParticleAttributes& value) {
  core_.execute(edit::SetAttributes{id, value});
}

bool Particles::is_oriented(ParticleId id) const {
  const model::Attributes* a = read::find_attributes(core_.model, core_.slot(id));
  return a && a->oriented;
}

Quaternion Particles::orientation(ParticleId id) const {
  return read::oriented_attributes(core_.model, core_.slot(id)).orientation;
}

Vec3 Particles::normal(ParticleId id) const { return rotate(orientation(id), {0, 0, 1}); }

Vec3 Particles::spin(ParticleId id) const { return read::oriented_attributes(core_.model, core_.slot(id)).spin; }

double Particles::moment(ParticleId id) const { return read::oriented_attributes(core_.model, core_.slot(id)).moment; }

void Particles::set_orientation(ParticleId id, const Quaternion& q) { core_.execute(edit::SetOrientation{id, q}); }

void Particles::set_spin(ParticleId id, const Vec3& value) { core_.execute(edit::SetSpin{id, value}); }

void Particles::set_moment(ParticleId id, double value) { core_.execute(edit::SetMoment{id, value}); }

void Particles::set_spin_damping(ParticleId id, double value) { core_.execute(edit::SetSpinDamping{id, value}); }

void Particles::apply_torque(ParticleId id, const Vec3& value) { core_.execute(edit::ApplyTorque{id, value}); }

void Particles::align(ParticleId id, const Vec3& direction, double stiffness, double damping) {
  core_.execute(edit::Align{id, direction, stiffness, damping});
}

ParticleId Particles::create(BodyId body, const Vec3& position, double mass, const Vec3& velocity) {
  return core_.execute(edit::CreateParticle{body, position, velocity, mass});
}

void Particles::destroy(ParticleId id) { core_.execute(edit::Destroy<ParticleId>{id}); }

void Particles::nail(ParticleId particle) { core_.execute(edit::Nail{particle, true, {}}); }

void Particles::nail(ParticleId particle, const Vec3& position) {
  core_.execute(edit::Nail{particle, false, position});
}

void Particles::release(ParticleId particle) { core_.execute(edit::Release{particle}); }

void Particles::set_position(ParticleId p, const Vec3& value) { core_.execute(edit::SetPosition{p, value}); }

void Particles::set_velocity(ParticleId p, const Vec3& value) { core_.execute(edit::SetVelocity{p, value}); }

void Particles::set_mass(ParticleId p, double value) { core_.execute(edit::SetMass{p, value}); }

void Particles::apply_force(ParticleId p, const Vec3& value) { core_.execute(edit::ApplyForce{p, value}); }

bool Particles::contains(ParticleId id) const { return core_.model.particles.contains(id); }

std::optional<ParticleId> Particles::survivor_of(ParticleId id) const { return core_.model.survivor_of(id); }

std::vector<ParticleId> Particles::ids() const { return core_.model.particles.ids(); }

BodyId Particles::body(ParticleId id) const {
  const model::Model& m = core_.model;
  return m.bodies.id(m.particles[core_.slot(id)].body);
}

std::vector<ParticleId> Particles::ring(ParticleId id) const {
  const model::Model& m = core_.model;
  std::vector<ParticleId> ids;
  m.for_each_in_ring(m.particles[core_.slot(id)].ring, [&](std::uint32_t p) { ids.push_back(m.particles.id(p)); });
  return ids;
}

Vec3 Particles::position(ParticleId id) const { return core_.model.position(core_.slot(id)); }

Vec3 Particles::velocity(ParticleId id) const { return core_.model.velocity(core_.slot(id)); }

double Particles::mass(ParticleId id) const {
  const model::Particle& p = core_.model.particles[core_.slot(id)];
  return p.inactive ? p.mass / model::inactive_share : p.mass;
}

bool Particles::is_nailed(ParticleId id) const {
  const model::Model& m = core_.model;
  return m.rings[m.particles[core_.slot(id)].ring].nailed == model::by_nail;
}

Vec3 Particles::nail_force(ParticleId id) const {
  const model::Model& m = core_.model;
  return -m.nails[m.particles[core_.slot(id)].ring].multiplier;
}

void Particles::read_positions(std::span<double> out) const {
  const model::Model& m = core_.model;
  if (out.size() != 3 * std::size_t{m.particles.size()})
    throw std::invalid_argument("read_positions needs room for 3 numbers a particle");
  double* write = out.data();
  m.particles.for_each([&](std::uint32_t, const model::Particle& p) {
    const Vec3& x = m.rings[p.ring].position;
    *write++ = x.x, *write++ = x.y, *write++ = x.z;
  });
}

void Particles::read_velocities(std::span<double> out) const {
  const model::Model& m = core_.model;
  if (out.size() != 3 * std::size_t{m.particles.size()})
    throw std::invalid_argument("read_velocities needs room for 3 numbers a particle");
  double* write = out.data();
  m.particles.for_each([&](std::uint32_t, const model::Particle& p) {
    const Vec3& v = m.rings[p.ring].velocity;
    *write++ = v.x, *write++ = v.y, *write++ = v.z;
  });
}

}  // namespace iota
