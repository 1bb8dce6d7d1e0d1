// SPDX-License-Identifier: Apache-2.0
#include "ingredient/loads.h"
#include "model/restructure.h"
#include "model/solid.h"
#include "system/core.h"

#include <algorithm>

namespace iota {

namespace {

Matrix3 to_rows(const Mat3& m) {
  Matrix3 rows;
  for (int i = 0; i < 3; ++i) rows[i] = {m.m[i][0], m.m[i][1], m.m[i][2]};
  return rows;
}

}  // namespace

BodyId System::create_body(const Shape& shape, const SolidOptions& options) {
  return implementation_->execute(edit::CreateSolid{shape, options});
}

ParticleId System::create_attachment(BodyId body, const Vec3& position) {
  return implementation_->execute(edit::CreateAttachment{body, position});
}

void System::set_pose(BodyId body, const Vec3& position, const Quaternion& orientation) {
  implementation_->execute(edit::SetPose{body, position, orientation});
}

void System::set_velocity(BodyId body, const Vec3& value) { implementation_->execute(edit::SetBodyVelocity{body, value}); }

void System::set_angular_velocity(BodyId body, const Vec3& value) {
  implementation_->execute(edit::SetAngularVelocity{body, value});
}

bool System::is_active(BodyId id) const { return kind(id) != BodyKind::inactive; }

void System::set_active(BodyId id, bool active) {
  if (active == is_active(id)) return;
  set_kind(id, active ? implementation_->model.bodies[id.slot].kind_before : BodyKind::inactive);
}

void System::set_articulate_active(BodyId id, bool active) {
  const model::Model& m = implementation_->model;
  std::vector<BodyId> members;
  m.for_each_body_of(m.bodies[implementation_->slot(id)].articulate,
                     [&](std::uint32_t b) { members.push_back(m.bodies.id(b)); });
  for (const BodyId body : members) set_active(body, active);
}

Matrix3 System::inertia(BodyId id) const {
  return to_rows(body_inertia(implementation_->model, implementation_->slot(id)));
}

Vec3 System::velocity(BodyId id) const { return body_velocity(implementation_->model, implementation_->slot(id)); }

Vec3 System::angular_velocity(BodyId id) const {
  return body_angular_velocity(implementation_->model, implementation_->slot(id));
}

Vec3 System::angular_momentum(BodyId id) const {
  return body_angular_momentum(implementation_->model, implementation_->slot(id));
}

std::vector<BodyId> System::parts(BodyId id) const {
  return parts_of(implementation_->model, implementation_->slot(id));
}

std::vector<ParticleId> System::particles(BodyId id, BodyId part) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  m.for_each_particle_of(implementation_->slot(id), [&](std::uint32_t p) {
    if (m.particles[p].part == part) ids.push_back(m.particles.id(p));
  });
  return ids;
}

Vec3 System::net_force(BodyId id) const { return ingredient::calc_net_load(implementation_->model, implementation_->slot(id), {}).force; }

Vec3 System::net_torque(BodyId id) const { return ingredient::calc_net_load(implementation_->model, implementation_->slot(id), {}).torque; }

Vec3 System::net_force(BodyId id, BodyId part) const {
  return ingredient::calc_net_load(implementation_->model, implementation_->slot(id), part).force;
}

Vec3 System::net_torque(BodyId id, BodyId part) const {
  return ingredient::calc_net_load(implementation_->model, implementation_->slot(id), part).torque;
}

Vec3 System::outside_force(BodyId id, BodyId part) const {
  return ingredient::calc_outside_load(implementation_->model, implementation_->slot(id), part).force;
}

Vec3 System::outside_torque(BodyId id, BodyId part) const {
  return ingredient::calc_outside_load(implementation_->model, implementation_->slot(id), part).torque;
}

std::vector<SolidView> System::solids(BodyId id) const {
  const model::Model& m = implementation_->model;
  std::vector<SolidView> views;
  m.for_each_solid_of(implementation_->slot(id), [&](std::uint32_t slot) {
    const model::Solid& solid = m.solids[slot];
    const model::SolidPose pose = solid_pose(m, slot);
    views.push_back({shape::from_data(solid.shape), pose.position, pose.orientation});
    const auto mesh = implementation_->editor.meshes.find(solid.shape.key);
    if (solid.shape.key != 0 && mesh != implementation_->editor.meshes.end()) views.back().shape = mesh->second;
  });
  return views;
}

std::vector<ParticleId> System::attachments(BodyId id) const {
  const model::Model& m = implementation_->model;
  const std::uint32_t body = implementation_->slot(id);
  std::vector<ParticleId> ids;
  m.for_each_particle_of(body, [&](std::uint32_t p) {
    bool own = false;
    m.for_each_solid_of(body, [&](std::uint32_t s) {
      own = own || std::find(m.solids[s].points.begin(), m.solids[s].points.end(), p) != m.solids[s].points.end();
    });
    if (!own && !m.particles[p].is_marker()) ids.push_back(m.particles.id(p));
  });
  return ids;
}

BodyId System::create_body(const BodyOptions& options) { return implementation_->execute(edit::CreateBody{options}); }

void System::set_rod(BodyId body, double mass, double radius) {
  implementation_->execute(edit::SetRod{body, mass, radius});
}

void System::destroy(BodyId id) { implementation_->execute(edit::Destroy<BodyId>{id}); }

void System::set_kind(BodyId body, BodyKind kind) { implementation_->execute(edit::SetKind{body, kind}); }

void System::set_damping(BodyId body, double per_second) {
  implementation_->execute(edit::SetBodyDamping{body, per_second});
}

std::uint32_t System::articulate_count() const { return implementation_->model.articulates.size(); }

bool System::contains(BodyId id) const { return implementation_->model.bodies.contains(id); }

std::optional<BodyId> System::survivor_of(BodyId id) const { return implementation_->model.survivor_of(id); }

std::vector<BodyId> System::bodies() const { return implementation_->model.bodies.ids(); }

std::vector<std::vector<BodyId>> System::articulates() const {
  const model::Model& m = implementation_->model;
  std::vector<std::vector<BodyId>> all;
  m.articulates.for_each([&](std::uint32_t slot, const model::Articulate&) {
    m.for_each_body_of(slot, [&, &bodies = all.emplace_back()](std::uint32_t b) { bodies.push_back(m.bodies.id(b)); });
  });
  return all;
}

std::vector<ParticleId> System::particles(BodyId body) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  m.for_each_particle_of(implementation_->slot(body), [&](std::uint32_t p) { ids.push_back(m.particles.id(p)); });
  return ids;
}

std::uint32_t System::articulate(BodyId id) const {
  return implementation_->model.bodies[implementation_->slot(id)].articulate;
}

BodyKind System::kind(BodyId id) const { return implementation_->model.bodies[implementation_->slot(id)].kind; }

double System::damping(BodyId id) const { return implementation_->model.bodies[implementation_->slot(id)].damping; }

double System::mass(BodyId id) const { return implementation_->model.body_mass(implementation_->slot(id)); }

Vec3 System::center_of_mass(BodyId id) const {
  return implementation_->model.center_of_mass(implementation_->slot(id));
}

Quaternion System::orientation(BodyId id) const {
  const std::uint32_t body = implementation_->slot(id);
  implementation_->orientations.refresh(implementation_->model);
  return implementation_->model.bodies[body].orientation;
}

}  // namespace iota
