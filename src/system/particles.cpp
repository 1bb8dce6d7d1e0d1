// SPDX-License-Identifier: Apache-2.0
#include "ingredient/loads.h"
#include "read/attributes.h"
#include "system/core.h"

#include <limits>

namespace iota {

void System::set_break_force(ParticleId id, double force) { implementation_->execute(edit::SetParticleBreakForce{id, force}); }

double System::break_force(ParticleId id) const {
  const model::Model& m = implementation_->model;
  const double* const force = m.fuses.find(implementation_->slot(id));
  return force ? *force : std::numeric_limits<double>::infinity();
}

Vec3 System::hinge_force(ParticleId id) const {
  return ingredient::calc_hinge_force(implementation_->model, implementation_->slot(id));
}

bool System::is_active(ParticleId id) const {
  return !implementation_->model.particles[implementation_->slot(id)].inactive;
}

void System::set_active(ParticleId id, bool active) { implementation_->execute(edit::SetParticleActive{id, active}); }

Vec3 System::net_force(ParticleId id) const {
  const model::Particle& p = implementation_->model.particles[implementation_->slot(id)];
  return p.mass * implementation_->model.rings[p.ring].acceleration;
}

ParticleAttributes System::attributes(ParticleId id) const {
  const model::Model& m = implementation_->model;
  const model::Attributes* a = read::find_attributes(m, implementation_->slot(id));
  return a ? read::attributes(m, *a) : ParticleAttributes{};
}

bool System::has_attributes(ParticleId id) const {
  return implementation_->model.particles[implementation_->slot(id)].attributes != model::none;
}

void System::set_attributes(ParticleId id, const ParticleAttributes& value) {
  implementation_->execute(edit::SetAttributes{id, value});
}

bool System::is_oriented(ParticleId id) const {
  const model::Attributes* a = read::find_attributes(implementation_->model, implementation_->slot(id));
  return a && a->oriented;
}

Quaternion System::orientation(ParticleId id) const {
  return read::oriented_attributes(implementation_->model, implementation_->slot(id)).orientation;
}

Vec3 System::normal(ParticleId id) const { return rotate(orientation(id), {0, 0, 1}); }

Vec3 System::spin(ParticleId id) const { return read::oriented_attributes(implementation_->model, implementation_->slot(id)).spin; }

double System::moment(ParticleId id) const {
  return read::oriented_attributes(implementation_->model, implementation_->slot(id)).moment;
}

void System::set_orientation(ParticleId id, const Quaternion& q) { implementation_->execute(edit::SetOrientation{id, q}); }

void System::set_spin(ParticleId id, const Vec3& value) { implementation_->execute(edit::SetSpin{id, value}); }

void System::set_moment(ParticleId id, double value) { implementation_->execute(edit::SetMoment{id, value}); }

void System::set_spin_damping(ParticleId id, double value) { implementation_->execute(edit::SetSpinDamping{id, value}); }

void System::apply_torque(ParticleId id, const Vec3& value) { implementation_->execute(edit::ApplyTorque{id, value}); }

void System::align(ParticleId id, const Vec3& direction, double stiffness, double damping) {
  implementation_->execute(edit::Align{id, direction, stiffness, damping});
}

ParticleId System::create_particle(BodyId body, const Vec3& position, double mass, const Vec3& velocity) {
  return implementation_->execute(edit::CreateParticle{body, position, velocity, mass});
}

void System::destroy(ParticleId id) { implementation_->execute(edit::Destroy<ParticleId>{id}); }

void System::nail(ParticleId particle) { implementation_->execute(edit::Nail{particle, true, {}}); }

void System::nail(ParticleId particle, const Vec3& position) {
  implementation_->execute(edit::Nail{particle, false, position});
}

void System::release(ParticleId particle) { implementation_->execute(edit::Release{particle}); }

void System::set_position(ParticleId p, const Vec3& value) { implementation_->execute(edit::SetPosition{p, value}); }

void System::set_velocity(ParticleId p, const Vec3& value) { implementation_->execute(edit::SetVelocity{p, value}); }

void System::set_mass(ParticleId p, double value) { implementation_->execute(edit::SetMass{p, value}); }

void System::apply_force(ParticleId p, const Vec3& value) { implementation_->execute(edit::ApplyForce{p, value}); }

bool System::contains(ParticleId id) const { return implementation_->model.particles.contains(id); }

std::optional<ParticleId> System::survivor_of(ParticleId id) const { return implementation_->model.survivor_of(id); }

std::vector<ParticleId> System::particles() const { return implementation_->model.particles.ids(); }

BodyId System::body(ParticleId id) const {
  const model::Model& m = implementation_->model;
  return m.bodies.id(m.particles[implementation_->slot(id)].body);
}

std::vector<ParticleId> System::ring(ParticleId id) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  m.for_each_in_ring(m.particles[implementation_->slot(id)].ring,
                     [&](std::uint32_t p) { ids.push_back(m.particles.id(p)); });
  return ids;
}

Vec3 System::position(ParticleId id) const { return implementation_->model.position(implementation_->slot(id)); }

Vec3 System::velocity(ParticleId id) const { return implementation_->model.velocity(implementation_->slot(id)); }

double System::mass(ParticleId id) const {
  const model::Particle& p = implementation_->model.particles[implementation_->slot(id)];
  return p.inactive ? p.mass / model::inactive_share : p.mass;
}

bool System::is_nailed(ParticleId id) const {
  const model::Model& m = implementation_->model;
  return m.rings[m.particles[implementation_->slot(id)].ring].nailed;
}

Vec3 System::nail_force(ParticleId id) const {
  const model::Model& m = implementation_->model;
  return -m.nails[m.particles[implementation_->slot(id)].ring].multiplier;
}

void System::read_positions(std::span<double> out) const {
  const model::Model& m = implementation_->model;
  if (out.size() != 3 * std::size_t{m.particles.size()})
    throw std::invalid_argument("read_positions needs room for 3 numbers a particle");
  double* write = out.data();
  m.particles.for_each([&](std::uint32_t, const model::Particle& p) {
    const Vec3& x = m.rings[p.ring].position;
    *write++ = x.x, *write++ = x.y, *write++ = x.z;
  });
}

void System::read_velocities(std::span<double> out) const {
  const model::Model& m = implementation_->model;
  if (out.size() != 3 * std::size_t{m.particles.size()})
    throw std::invalid_argument("read_velocities needs room for 3 numbers a particle");
  double* write = out.data();
  m.particles.for_each([&](std::uint32_t, const model::Particle& p) {
    const Vec3& v = m.rings[p.ring].velocity;
    *write++ = v.x, *write++ = v.y, *write++ = v.z;
  });
}

}  // namespace iota
