// SPDX-License-Identifier: Apache-2.0
#include "ingredient/contact_readings.h"
#include "ingredient/loads.h"
#include "ingredient/quantities.h"
#include "model/outline.h"
#include "model/restructure.h"
#include "model/solid.h"
#include "system/core.h"

#include <algorithm>
#include <span>

namespace iota {

namespace {

Matrix3 to_rows(const Mat3& m) {
  Matrix3 rows;
  for (int i = 0; i < 3; ++i) rows[i] = {m.m[i][0], m.m[i][1], m.m[i][2]};
  return rows;
}

}  // namespace

BodyId Bodies::create(const Shape& shape, const SolidOptions& options) {
  return core_.execute(edit::CreateSolid{shape, options});
}

BodyId Bodies::create_obstacle(const Shape& shape, const Vec3& position, const Quaternion& orientation) {
  return core_.execute(edit::CreateObstacle{shape, position, orientation});
}

ParticleId Bodies::create_attachment(BodyId body, const Vec3& position) {
  return core_.execute(edit::CreateAttachment{body, position});
}

void Bodies::set_pose(BodyId body, const Vec3& position, const Quaternion& orientation) {
  core_.execute(edit::SetPose{body, position, orientation});
}

std::string Bodies::name(BodyId id) const {
  const std::uint32_t body = core_.slot(id);
  return core_.model.names[body].data();
}

void Bodies::set_name(BodyId body, std::string_view name) { core_.execute(edit::SetBodyName{body, std::string(name)}); }

void Bodies::set_mass(BodyId body, double kg) { core_.execute(edit::SetBodyMass{body, kg}); }

void Bodies::apply_force(BodyId body, const Vec3& newtons) {
  core_.execute(edit::ApplyBodyForce{body, newtons, true, {}});
}

void Bodies::apply_force(BodyId body, const Vec3& newtons, const Vec3& at) {
  core_.execute(edit::ApplyBodyForce{body, newtons, false, at});
}

void Bodies::apply_torque(BodyId body, const Vec3& newton_meters) {
  core_.execute(edit::ApplyBodyTorque{body, newton_meters});
}

BodyEnergy Bodies::energy(BodyId id) const {
  const ingredient::Energies energies = ingredient::calc_energies(ingredient::Scope(core_.model, core_.slot(id)));
  return {energies.kinetic, energies.potential};
}

void Bodies::set_velocity(BodyId body, const Vec3& value) { core_.execute(edit::SetBodyVelocity{body, value}); }

void Bodies::set_angular_velocity(BodyId body, const Vec3& value) {
  core_.execute(edit::SetAngularVelocity{body, value});
}

bool Bodies::is_active(BodyId id) const { return kind(id) != BodyKind::inactive; }

void Bodies::set_active(BodyId id, bool active) {
  if (active == is_active(id)) return;
  set_kind(id, active ? core_.model.bodies[id.slot].kind_before : BodyKind::inactive);
}

void Bodies::set_articulate_active(BodyId id, bool active) {
  const model::Model& m = core_.model;
  std::vector<BodyId> members;
  m.for_each_body_of(m.bodies[core_.slot(id)].articulate, [&](std::uint32_t b) { members.push_back(m.bodies.id(b)); });
  for (const BodyId body : members) set_active(body, active);
}

Matrix3 Bodies::inertia(BodyId id) const { return to_rows(body_inertia(core_.model, core_.slot(id))); }

Vec3 Bodies::velocity(BodyId id) const { return body_velocity(core_.model, core_.slot(id)); }

Vec3 Bodies::angular_velocity(BodyId id) const { return body_angular_velocity(core_.model, core_.slot(id)); }

Vec3 Bodies::angular_momentum(BodyId id) const { return body_angular_momentum(core_.model, core_.slot(id)); }

std::vector<BodyId> Bodies::parts(BodyId id) const { return parts_of(core_.model, core_.slot(id)); }

std::vector<ParticleId> Bodies::particles(BodyId id, BodyId part) const {
  const model::Model& m = core_.model;
  std::vector<ParticleId> ids;
  m.for_each_particle_of(core_.slot(id), [&](std::uint32_t p) {
    if (m.particles[p].part == part) ids.push_back(m.particles.id(p));
  });
  return ids;
}

Vec3 Bodies::net_force(BodyId id) const { return ingredient::calc_net_load(core_.model, core_.slot(id), {}).force; }

Vec3 Bodies::net_torque(BodyId id) const { return ingredient::calc_net_load(core_.model, core_.slot(id), {}).torque; }

Vec3 Bodies::net_force(BodyId id, BodyId part) const {
  return ingredient::calc_net_load(core_.model, core_.slot(id), part).force;
}

Vec3 Bodies::net_torque(BodyId id, BodyId part) const {
  return ingredient::calc_net_load(core_.model, core_.slot(id), part).torque;
}

Vec3 Bodies::outside_force(BodyId id, BodyId part) const {
  return ingredient::calc_outside_load(core_.model, core_.slot(id), part).force;
}

Vec3 Bodies::outside_torque(BodyId id, BodyId part) const {
  return ingredient::calc_outside_load(core_.model, core_.slot(id), part).torque;
}

std::vector<SolidView> Bodies::solids(BodyId id) const {
  const model::Model& m = core_.model;
  std::vector<SolidView> views;
  m.for_each_solid_of(core_.slot(id), [&](std::uint32_t slot) {
    const model::Solid& solid = m.solids[slot];
    const model::SolidPose pose = solid_pose(m, slot);
    views.push_back({shape::from_data(solid.shape), pose.position, pose.orientation});
    if (const std::shared_ptr<const Mesh> mesh = m.meshes.find(solid.shape.key)) views.back().shape = *mesh;
  });
  return views;
}

std::vector<ParticleId> Bodies::attachments(BodyId id) const {
  const model::Model& m = core_.model;
  const std::uint32_t body = core_.slot(id);
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

BodyId Bodies::create(const BodyOptions& options) { return core_.execute(edit::CreateBody{options}); }

void Bodies::set_mass_properties(BodyId body, double mass, const Vec3& center, const Matrix3& inertia) {
  core_.execute(edit::SetMassProperties{body, mass, center, inertia});
}

void Bodies::set_rod(BodyId body, double mass, double radius) { core_.execute(edit::SetRod{body, mass, radius}); }

void Bodies::destroy(BodyId id) { core_.execute(edit::Destroy<BodyId>{id}); }

void Bodies::set_kind(BodyId body, BodyKind kind) { core_.execute(edit::SetKind{body, kind}); }

int Bodies::stride(BodyId id) const {
  const std::uint32_t stride = ingredient::Strides::of(core_.model, core_.slot(id));
  return stride == ingredient::Strides::frozen ? 0 : static_cast<int>(stride);
}

namespace {

std::uint32_t require_stride(int steps) {
  if (steps < 0) throw std::invalid_argument(text("stride must be 1 (every step) or more, or 0 (frozen), got ", steps));
  return static_cast<std::uint32_t>(steps);
}

}  // namespace

void Bodies::set_stride(BodyId body, int steps) {
  core_.execute(ingredient::SetStride{body, require_stride(steps), false});
}

void Bodies::set_articulate_stride(BodyId body, int steps) {
  core_.execute(ingredient::SetStride{body, require_stride(steps), true});
}

void Bodies::set_damping(BodyId body, double per_second) { core_.execute(edit::SetBodyDamping{body, per_second}); }

std::uint32_t Bodies::articulate_count() const { return core_.model.articulate_count(); }

bool Bodies::contains(BodyId id) const { return core_.model.bodies.contains(id); }

std::optional<BodyId> Bodies::survivor_of(BodyId id) const { return core_.model.survivor_of(id); }

bool Bodies::is_obstacle(BodyId id) const { return core_.model.obstacles.has(core_.slot(id)); }

std::vector<BodyId> Bodies::ids() const {
  std::vector<BodyId> ids = core_.model.bodies.ids();
  if (!core_.model.obstacles.is_empty())
    std::erase_if(ids, [&](BodyId id) { return core_.model.obstacles.has(id.slot); });
  return ids;
}

std::vector<BodyId> Bodies::obstacles() const {
  std::vector<BodyId> ids;
  core_.model.obstacles.for_each(
      [&](std::uint32_t body, const model::Obstacle&) { ids.push_back(core_.model.bodies.id(body)); });
  std::ranges::sort(ids, {}, &BodyId::slot);
  return ids;
}

std::vector<std::vector<BodyId>> Bodies::articulates() const {
  const model::Model& m = core_.model;
  std::vector<std::vector<BodyId>> all;
  m.articulates.for_each([&](std::uint32_t slot, const model::Articulate& articulate) {
    if (m.obstacles.has(articulate.first)) return;
    m.for_each_body_of(slot, [&, &bodies = all.emplace_back()](std::uint32_t b) { bodies.push_back(m.bodies.id(b)); });
  });
  return all;
}

std::vector<ParticleId> Bodies::particles(BodyId body) const {
  const model::Model& m = core_.model;
  std::vector<ParticleId> ids;
  m.for_each_particle_of(core_.slot(body), [&](std::uint32_t p) { ids.push_back(m.particles.id(p)); });
  return ids;
}

std::vector<BodyId> Bodies::articulate_of(BodyId id) const {
  const model::Model& m = core_.model;
  if (m.obstacles.has(core_.slot(id))) return {};
  std::vector<std::uint32_t> slots;
  m.for_each_body_of(articulate(id), [&](std::uint32_t body) { slots.push_back(body); });
  std::ranges::sort(slots);
  std::vector<BodyId> out;
  for (const std::uint32_t slot : slots) out.push_back(m.bodies.id(slot));
  return out;
}

std::uint32_t Bodies::articulate(BodyId id) const { return core_.model.bodies[core_.slot(id)].articulate; }

BodyKind Bodies::kind(BodyId id) const { return core_.model.bodies[core_.slot(id)].kind; }

double Bodies::damping(BodyId id) const { return core_.model.body_damping[core_.slot(id)]; }

double Bodies::radius(BodyId id) const { return model::radius_of(core_.model, core_.slot(id)); }

void Bodies::set_radius(BodyId body, double meters) { core_.execute(edit::SetRadius{body, meters}); }

std::optional<std::uint32_t> Bodies::color(BodyId id) const {
  const std::uint32_t* const color = core_.model.colors.find(core_.slot(id));
  return color ? std::optional(*color) : std::nullopt;
}

void Bodies::set_color(BodyId body, std::optional<std::uint32_t> rgb) {
  core_.execute(edit::SetColor{body, rgb.has_value(), rgb.value_or(0)});
}

std::optional<Material> Bodies::material(BodyId id) const {
  const Material* const material = core_.model.materials.find(core_.slot(id));
  return material ? std::optional(*material) : std::nullopt;
}

void Bodies::set_material(BodyId body, const std::optional<Material>& material) {
  core_.execute(edit::SetMaterial{body, material.has_value(), material.value_or(Material{})});
}

std::vector<ContactPoint> Bodies::contacts(BodyId id) const {
  return ingredient::contact_points(core_.model, core_.slot(id));
}

double Bodies::mass(BodyId id) const { return core_.model.body_mass(core_.slot(id)); }

Vec3 Bodies::center_of_mass(BodyId id) const { return core_.model.center_of_mass(core_.slot(id)); }

Quaternion Bodies::orientation(BodyId id) const {
  const std::uint32_t body = core_.slot(id);
  core_.orientations.refresh(core_.model, std::span(&body, 1));
  return core_.model.bodies[body].orientation;
}

}  // namespace iota
