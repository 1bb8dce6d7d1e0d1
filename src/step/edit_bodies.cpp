// SPDX-License-Identifier: Apache-2.0
// Bodies as wholes: given by shape, moved, spun.
#include "ingredient/loads.h"
#include "model/solid.h"
#include "step/checks.h"
#include "step/execute.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace iota {

using namespace step;
using model::none;

namespace {

Mat3 to_mat3(const Matrix3& rows) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.m[i][0] = rows[i].x, m.m[i][1] = rows[i].y, m.m[i][2] = rows[i].z;
  return m;
}

Matrix3 to_rows(const Mat3& m) {
  Matrix3 rows;
  for (int i = 0; i < 3; ++i) rows[i] = {m.m[i][0], m.m[i][1], m.m[i][2]};
  return rows;
}

/// Of a body whose shape has no volume: four points that stand for a cube of 1 m give it a frame.
constexpr MassProperties frame_only{1, {}, {{{1.0 / 12, 0, 0}, {0, 1.0 / 12, 0}, {0, 0, 1.0 / 12}}}};

Quaternion unit(std::string_view name, const Quaternion& q) {
  const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!(length2 > 1e-12) || !std::isfinite(length2))
    throw std::invalid_argument(text(name, " must be a quaternion x y z w that is finite and not zero, got (", q.x,
                                     ", ", q.y, ", ", q.z, ", ", q.w, ")"));
  return normalized(q);
}

}  // namespace

BodyId System::create_body(const Shape& shape, const SolidOptions& o) {
  const bool can_move = o.kind != BodyKind::static_ && o.kind != BodyKind::scripted;
  const MassProperties p = can_move || shape::is_solid(shape) ? mass_properties(shape) : frame_only;
  CreateSolid command{};
  command.kind = o.kind, command.damping = o.damping;
  command.shape = shape::to_data(shape);
  if (std::isnan(o.mass)) require_positive("density", o.density);
  command.mass = std::isnan(o.mass) ? o.density * p.volume : o.mass;
  command.center = p.center, command.mean_squares = p.mean_squares;
  command.position = o.position, command.velocity = o.velocity, command.spin = o.spin;
  command.orientation = unit("orientation", o.orientation);
  for (const Vec3& a : o.attachments) require_finite("each attachment", a);
  const BodyId body = implementation_->execute(command);
  if (const auto* mesh = std::get_if<Mesh>(&shape)) implementation_->meshes.try_emplace(command.shape.key, *mesh);
  for (const Vec3& a : o.attachments) create_attachment(body, o.position + rotate(command.orientation, a));
  return body;
}
ParticleId System::create_attachment(BodyId body, const Vec3& position) {
  return implementation_->execute(CreateAttachment{body, position});
}
void System::set_pose(BodyId body, const Vec3& position, const Quaternion& orientation) {
  implementation_->execute(SetPose{body, position, orientation});
}
void System::set_velocity(BodyId body, const Vec3& value) { implementation_->execute(SetBodyVelocity{body, value}); }
void System::set_angular_velocity(BodyId body, const Vec3& value) {
  implementation_->execute(SetAngularVelocity{body, value});
}

bool System::is_active(BodyId id) const { return kind(id) != BodyKind::inactive; }
void System::set_active(BodyId id, bool active) {
  if (active == is_active(id)) return;
  set_kind(id, active ? implementation_->model.bodies[id.slot].kind_before : BodyKind::inactive);
}
void System::set_articulate_active(BodyId id, bool active) {
  const model::Model& m = implementation_->model;
  std::vector<BodyId> members;
  m.for_each_body_of(m.bodies[implementation_->require(id)].articulate,
                     [&](std::uint32_t b) { members.push_back(m.bodies.id(b)); });
  for (const BodyId body : members) set_active(body, active);
}
bool System::is_active(ParticleId id) const {
  return !implementation_->model.particles[implementation_->require(id)].inactive;
}
void System::set_active(ParticleId id, bool active) { implementation_->execute(SetParticleActive{id, active}); }
RestOptions System::rest() const { return {implementation_->model.rest_after, implementation_->model.rest_speed}; }
void System::set_rest(const RestOptions& options) { implementation_->execute(SetRest{options}); }

Matrix3 System::inertia(BodyId id) const {
  return to_rows(body_inertia(implementation_->model, implementation_->require(id)));
}
Vec3 System::velocity(BodyId id) const { return body_velocity(implementation_->model, implementation_->require(id)); }
Vec3 System::angular_velocity(BodyId id) const {
  return body_angular_velocity(implementation_->model, implementation_->require(id));
}
Vec3 System::angular_momentum(BodyId id) const {
  return body_angular_momentum(implementation_->model, implementation_->require(id));
}

RestructureReport System::separate(BodyId body, BodyId part) {
  return implementation_->execute(SeparatePart{body, part});
}
std::vector<BodyId> System::parts(BodyId id) const {
  return parts_of(implementation_->model, implementation_->require(id));
}
std::vector<ParticleId> System::particles(BodyId id, BodyId part) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  m.for_each_particle_of(implementation_->require(id), [&](std::uint32_t p) {
    if (m.particles[p].part == part) ids.push_back(m.particles.id(p));
  });
  return ids;
}

Vec3 System::net_force(ParticleId id) const {
  const model::Particle& p = implementation_->model.particles[implementation_->require(id)];
  return p.mass * implementation_->model.rings[p.ring].acceleration;
}
Vec3 System::net_force(BodyId id) const {
  return ingredient::calc_net_load(implementation_->model, implementation_->require(id), {}).force;
}
Vec3 System::net_torque(BodyId id) const {
  return ingredient::calc_net_load(implementation_->model, implementation_->require(id), {}).torque;
}
Vec3 System::net_force(BodyId id, BodyId part) const {
  return ingredient::calc_net_load(implementation_->model, implementation_->require(id), part).force;
}
Vec3 System::net_torque(BodyId id, BodyId part) const {
  return ingredient::calc_net_load(implementation_->model, implementation_->require(id), part).torque;
}

Vec3 System::outside_force(BodyId id, BodyId part) const {
  return ingredient::calc_outside_load(implementation_->model, implementation_->require(id), part).force;
}
Vec3 System::outside_torque(BodyId id, BodyId part) const {
  return ingredient::calc_outside_load(implementation_->model, implementation_->require(id), part).torque;
}

std::vector<SolidView> System::solids(BodyId id) const {
  const model::Model& m = implementation_->model;
  std::vector<SolidView> views;
  m.for_each_solid_of(implementation_->require(id), [&](std::uint32_t slot) {
    const model::Solid& solid = m.solids[slot];
    const model::SolidPose pose = solid_pose(m, slot);
    views.push_back({shape::from_data(solid.shape), pose.position, pose.orientation});
    const auto mesh = implementation_->meshes.find(solid.shape.key);
    if (solid.shape.key != 0 && mesh != implementation_->meshes.end()) views.back().shape = mesh->second;
  });
  return views;
}

std::vector<ParticleId> System::attachments(BodyId id) const {
  const model::Model& m = implementation_->model;
  const std::uint32_t body = implementation_->require(id);
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

BodyId System::Implementation::apply(const CreateSolid& c) {
  require_not_negative("damping", c.damping);
  require_mass("mass", c.mass);
  require_finite("position", c.position);
  require_finite("velocity", c.velocity);
  require_finite("spin", c.spin);
  shape::check(shape::from_data(c.shape));
  const std::uint32_t body = model.make_body(c.kind, c.damping);
  model::Solid solid;
  solid.shape = c.shape;
  const model::SolidPose pose{c.position, c.orientation};
  add_solid(model, body, solid, c.mass, c.center, to_mat3(c.mean_squares), pose);
  const Vec3 center = model.center_of_mass(body);
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model::Ring& ring = model.rings[model.particles[p].ring];
    ring.velocity = c.velocity + cross(c.spin, ring.position - center);
  });
  structure_changed();
  return model.bodies.id(body);
}

ParticleId System::Implementation::apply(const CreateAttachment& c) {
  const std::uint32_t body = require(c.body);
  require_finite("position", c.position);
  if (model.bodies[body].first_solid == none)
    throw std::invalid_argument(text("create_attachment is for bodies given by shape, but body ", body,
                                     " is made of particles alone: use create_particle"));
  std::uint32_t solid = none;
  double nearest = 0;
  model.for_each_solid_of(body, [&](std::uint32_t s) {
    const double distance = norm(solid_pose(model, s).position - c.position);
    if (is_untouched(model, s) && (solid == none || distance < nearest)) solid = s, nearest = distance;
  });
  if (solid == none)
    throw std::invalid_argument(
        text("create_attachment: something is hinged, nailed or bonded to the own four points of "
             "body ",
             body, ", which therefore cannot give; use attachments for that"));
  const std::uint32_t particle = attach(model, solid, c.position);
  // Velocities of the mid-point rule are rigid on the average only, so a new basis may carry the others differently.
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (model.is_unknown(model.particles[p])) return;
    model::Ring& ring = model.rings[model.particles[p].ring];
    std::tie(ring.position, ring.velocity) = model.carried(p);
  });
  jolt(particle);
  structure_changed();
  return model.particles.id(particle);
}

// The whole articulate moves as if it were rigid, so that no joint notices.
static void require_particles(const model::Model& model, std::uint32_t body) {
  if (model.bodies[body].count == 0) throw std::invalid_argument(text("body ", body, " has no particles to move"));
}

void System::Implementation::apply(const SetPose& c) {
  const std::uint32_t body = require(c.body);
  if (model.bodies[body].count == 0) throw std::invalid_argument(text("set_pose: body ", body, " has no particles"));
  require_finite("position", c.position);
  const Quaternion wanted = unit("orientation", c.orientation);
  require_particles(model, body);
  refresh_orientations();
  const Quaternion& q = model.bodies[body].orientation;
  const Quaternion turn = multiply(wanted, {-q.x, -q.y, -q.z, q.w});
  const Vec3 center = model.center_of_mass(body);
  const auto moved = [&](const Vec3& x) { return c.position + rotate(turn, x - center); };
  const std::uint32_t articulate = model.bodies[body].articulate;
  if (model.bodies[body].kind == BodyKind::scripted) {
    model.for_each_particle_of(
        body, [&](std::uint32_t p) { apply(Nail{model.particles.id(p), false, moved(model.position(p))}); });
    return;
  }
  std::vector<std::uint32_t> rings;
  double mass = 0;
  Vec3 momentum;
  model.for_each_body_of(articulate, [&](std::uint32_t b) {
    model.for_each_particle_of(b, [&](std::uint32_t p) {
      rings.push_back(model.particles[p].ring);
      mass += model.particles[p].mass, momentum += model.particles[p].mass * model.velocity(p);
    });
  });
  std::sort(rings.begin(), rings.end());
  rings.erase(std::unique(rings.begin(), rings.end()), rings.end());
  const Vec3 mean = (1 / mass) * momentum;  // velocities turn along, so that momentum and kinetic energy stay
  for (const std::uint32_t slot : rings) {
    model::Ring& ring = model.rings[slot];
    ring.position = moved(ring.position);
    ring.velocity = mean + rotate(turn, ring.velocity - mean);
    // Of a static body's rings too, or what is tied to it would bring it back.
    if (model::Nail* const nail = model.nails.find(slot))
      nail->position = nail->position_before = moved(nail->position);
  }
  model.for_each_body_of(articulate, [&](std::uint32_t b) { refresh_coordinates(b); });
  model.bodies[body].orientation = wanted;
  oriented_step = ~0ull;
  jolt(model.bodies[body].first);
}

void System::Implementation::put_to_rest(std::uint32_t body) {
  islands.update(model, parallel);
  const std::vector<std::uint32_t> affected = model.tied_bodies(std::array{body});
  const std::uint32_t articulate = model.bodies[body].articulate;
  if (const step::Island* const island = islands.of_articulate(articulate))
    island->put_to_rest(model);
  else
    step::FreeParticles::put_to_rest(model, articulate);
  for (const std::uint32_t b : affected) {
    model::Articulate& a = model.articulates[model.bodies[b].articulate];
    a.disturbed = a.jolted = 0;
  }
}

void System::Implementation::apply(const SetParticleActive& c) {
  const std::uint32_t slot = require(c.particle);
  model::Particle& p = model.particles[slot];
  if (p.inactive != static_cast<std::uint8_t>(c.active)) return;
  p.inactive = !c.active;
  p.mass *= c.active ? 1 / model::inactive_share : model::inactive_share;
  model.mute_bonds_of(slot);
  model.for_each_bond_of(slot, [&](std::uint32_t b) {
    for (const std::uint32_t end : {model.bonds[b].p, model.bonds[b].q}) model.touch_particle(end);
  });
  model.touch_particle(slot);
  structure_changed();
}

void System::Implementation::apply(const SetRest& c) {
  require_not_negative("rest.after", c.options.after);
  require_not_negative("rest.speed", c.options.speed);
  model.rest_after = c.options.after, model.rest_speed = c.options.speed;
}

template <class Motion>
void System::Implementation::add_motion(std::uint32_t body, Motion motion) {
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model::Ring& ring = model.rings[model.particles[p].ring];
    ring.velocity += motion(ring.position);
  });
  jolt(model.bodies[body].first);
}

void System::Implementation::apply(const SetBodyVelocity& c) {
  const std::uint32_t body = require(c.body);
  require_finite("velocity", c.value);
  require_particles(model, body);
  const Vec3 change = c.value - body_velocity(model, body);
  add_motion(body, [&](const Vec3&) { return change; });
}

/// Points on a line have no inertia about it: there is nothing that could keep such a spin. A rod has.
static void require_can_spin(const model::Model& model, std::uint32_t slot, const Vec3& spin) {
  constexpr double along = 1e-6;  // of the spin: round-off
  const model::Body& body = model.bodies[slot];
  if (body.rank > 2 || spin == Vec3{} || model.axial_inertia(slot) > 0) return;
  const Vec3 axis = model.position(body.basis[body.rank - 1]) - model.position(body.basis[0]);
  if (body.rank == 2 && std::abs(dot(spin, axis)) <= along * norm(spin) * norm(axis)) return;
  throw std::invalid_argument(
      text("set_angular_velocity: the particles of body ", slot,
           body.rank == 2 ? " are on one line, about which they have no inertia and cannot spin" : " are at one place",
           "; a body given by shape can, or a rod (set_rod)"));
}

void System::Implementation::apply(const SetAngularVelocity& c) {
  const std::uint32_t body = require(c.body);
  require_finite("angular velocity", c.value);
  require_particles(model, body);
  require_can_spin(model, body, c.value);
  const Vec3 change = c.value - body_angular_velocity(model, body), center = model.center_of_mass(body);
  add_motion(body, [&](const Vec3& x) { return cross(change, x - center); });
  if (!(model.axial_inertia(body) > 0)) return;
  constexpr double round_off = 1e-12;
  const double spin = dot(c.value, model.rod_axis(body));
  model.set_spin(body, std::abs(spin) > round_off * norm(c.value) ? spin : 0);
}

}  // namespace iota
