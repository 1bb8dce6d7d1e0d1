// SPDX-License-Identifier: Apache-2.0
#include "edit/bodies.h"

#include "base/sort_unique.h"
#include "edit/constraints.h"
#include "edit/nails.h"
#include "edit/settle.h"
#include "ingredient/attachments.h"
#include "math/checks.h"
#include "math/mat3.h"
#include "model/obstacle.h"
#include "model/outline.h"
#include "model/solid.h"
#include "shape/mesh.h"
#include "shape/shape.h"

#include <iota/reports.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace iota::edit {

using model::none;

void require_own_motion(BodyKind kind, const char* what, const Vec3& value) {
  if (value == Vec3{} || (kind != BodyKind::static_ && kind != BodyKind::scripted)) return;
  throw std::invalid_argument(
      kind == BodyKind::static_
          ? text(what, ": a static body does not move")
          : text(what,
                 ": a scripted body goes where its places are set, and has the velocity of that: set its position, or "
                 "set_pose, before each step"));
}

namespace {

Mat3 to_mat3(const Matrix3& rows) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.m[i][0] = rows[i].x, m.m[i][1] = rows[i].y, m.m[i][2] = rows[i].z;
  return m;
}

/// For a body whose shape has no volume: the four points of a cube of 1 m give it a frame.
constexpr MassProperties frame_only{1, {}, {{{1.0 / 12, 0, 0}, {0, 1.0 / 12, 0}, {0, 0, 1.0 / 12}}}};

void require_shape(const Shape& shape) {
  shape::check(shape);
  if (const Mesh* const mesh = std::get_if<Mesh>(&shape)) shape::Traits<Mesh>::check_triangles(*mesh);
}

/// A shape as the model keeps it, for one more solid. is_open: a mesh without a volume.
shape::Data stored(model::Model& model, const Shape& shape, bool is_open) {
  const shape::Data data = shape::to_data(shape);
  if (const Mesh* const mesh = std::get_if<Mesh>(&shape)) model.meshes.add_use(data.key, *mesh, is_open);
  return data;
}

}  // namespace

BodyId apply(Editor& e, const CreateBody& c) {
  model::Model& model = e.model;
  require_not_negative("damping", c.options.damping);
  const std::uint32_t body = model.make_body(c.options.kind, c.options.damping);
  e.structure_changed();
  return model.bodies.id(body);
}

BodyId apply(Editor& e, const CreateSolid& c) {
  model::Model& model = e.model;
  const SolidOptions& o = c.options;
  require_shape(c.shape);
  const bool can_move = o.kind != BodyKind::static_ && o.kind != BodyKind::scripted;
  const bool has_volume = can_move || shape::is_solid(c.shape);
  const MassProperties properties = has_volume ? mass_properties(c.shape) : frame_only;
  if (std::isnan(o.mass)) require_positive("density", o.density);
  const double mass = std::isnan(o.mass) ? o.density * properties.volume : o.mass;
  require_not_negative("damping", o.damping);
  require_mass("mass", mass);
  require_finite("position", o.position);
  require_finite("velocity", o.velocity);
  require_finite("spin", o.spin);
  require_own_motion(o.kind, "velocity", o.velocity), require_own_motion(o.kind, "spin", o.spin);
  for (const Vec3& a : o.attachments) require_finite("each attachment", a);
  const model::SolidPose pose{o.position, require_quaternion("orientation", o.orientation)};

  const std::uint32_t body = model.make_body(o.kind, o.damping);
  model::Solid solid;
  solid.shape = stored(model, c.shape, !has_volume);
  add_solid(model, body, solid, mass, properties.center, to_mat3(properties.mean_squares), pose);
  const Vec3 center = model.center_of_mass(body);
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model::Ring& ring = model.rings[model.particles[p].ring];
    ring.velocity = o.velocity + cross(o.spin, ring.position - center);
  });
  e.structure_changed();
  const BodyId id = model.bodies.id(body);
  for (const Vec3& a : o.attachments) (void)apply(e, CreateAttachment{id, o.position + rotate(pose.orientation, a)});
  return id;
}

BodyId apply(Editor& e, const CreateObstacle& c) {
  model::Model& model = e.model;
  require_shape(c.shape);
  require_finite("position", c.position);
  const model::SolidPose pose{c.position, require_quaternion("orientation", c.orientation)};
  const std::uint32_t body = model.make_body(BodyKind::static_, 0);
  make_obstacle(model, body, stored(model, c.shape, !shape::is_solid(c.shape)), pose);
  e.structure_changed();
  return model.bodies.id(body);
}

void refuse_obstacle(const model::Model& model, std::uint32_t body, const char* what) {
  if (model.obstacles.has(body))
    throw std::invalid_argument(
        text("body ", body, " is an obstacle, which cannot ", what, ": make it a static body given by shape instead"));
}

ParticleId apply(Editor& e, const CreateAttachment& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  refuse_obstacle(model, body, "have particles");
  require_finite("position", c.position);
  if (model.bodies[body].first_solid == none)
    throw std::invalid_argument(text("create_attachment is for bodies given by shape, but body ", body,
                                     " is made of particles alone: use create_particle"));
  const std::uint32_t solid = solid_that_gives(model, body, c.position);
  if (solid == none)
    throw std::invalid_argument(
        text("create_attachment: something is hinged, nailed or bonded to the own four points of "
             "body ",
             body, ", which therefore cannot give; use attachments for that"));
  const std::uint32_t particle = attach(model, solid, c.position);
  carry_points(model, body);
  e.mark_velocity_dirty(particle);
  e.structure_changed();
  return model.particles.id(particle);
}

void apply(Editor& e, const SetRod& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_mass("mass", c.mass);
  require_size("radius", c.radius);
  std::vector<std::uint32_t> massive;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (!model.particles[p].is_marker()) massive.push_back(p);
  });
  if (massive.size() != 2)
    throw std::invalid_argument(
        text("set_rod needs a body of exactly two massive particles, body ", body, " has ", massive.size()));
  const std::uint32_t p = massive[0], q = massive[1];
  const double length = norm(model.position(q) - model.position(p));
  require_positive("the distance of the rod's two particles", length);
  // Mass [A B; B A] as two point masses A+B = m/2 and a pair -B |v_p - v_q|^2 / 2, where A-B = 2 It/L^2.
  const double transverse = c.mass * (3 * c.radius * c.radius + length * length) / 12;
  const double sum = c.mass / 2, difference = 2 * transverse / (length * length);
  model.remove_inertia_of(body, none);
  for (const std::uint32_t end : {p, q}) model.particles[end].mass = sum;
  model::InertiaPair pair{body, none, p, q, -(sum - difference) / 2};
  model.bodies[body].first_inertia = model.inertia_pairs.create(pair).slot;
  model.mark_body(body);
}

void apply(Editor& e, const SetMassProperties& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  refuse_obstacle(model, body, "have a mass");
  require_mass("mass", c.mass);
  require_finite("center", c.center);
  for (const Vec3& row : c.inertia)
    if (!is_finite(row)) throw std::invalid_argument("inertia must be finite");
  std::size_t own = 0;
  bool may_move = true;
  model.for_each_solid_of(body, [&](std::uint32_t solid) {
    own += model.solids[solid].points.size();
    may_move = may_move && model::may_move_points(model, solid);
  });
  if (own == 0) throw std::invalid_argument(text("set_mass_properties is for bodies given by shape, not body ", body));
  if (own != model.bodies[body].count || !may_move)
    throw std::invalid_argument(text("set_mass_properties: body ", body,
                                     " has particles beside those of its shapes, or ",
                                     "something holds them: give it attachments, hinges and nails afterwards"));
  const Mat3 inertia = to_mat3(c.inertia);
  const double trace = inertia.m[0][0] + inertia.m[1][1] + inertia.m[2][2];
  Mat3 squares;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (std::abs(inertia.m[i][j] - inertia.m[j][i]) > 1e-9 * std::abs(trace))
        throw std::invalid_argument("inertia must be symmetric");
      squares.m[i][j] = ((i == j ? trace / 2 : 0) - (inertia.m[i][j] + inertia.m[j][i]) / 2) / c.mass;
    }
  const SymmetricEigen spread = symmetric_eigen(squares);
  const double least = *std::min_element(std::begin(spread.values), std::end(spread.values));
  const double most = *std::max_element(std::begin(spread.values), std::end(spread.values));
  if (!(least > 1e-9 * most))
    throw std::invalid_argument(
        "inertia must be of a body that has a size along each axis: each principal moment is "
        "above 0 and less than the sum of the other two");
  model::set_mass_properties(model, body, c.mass, c.center, squares);
  e.structure_changed();
}

// --- kind -------------------------------------------------------------------------------------------------------------

namespace {

void put_to_rest(Editor& e, std::uint32_t body) {
  model::Model& model = e.model;
  e.islands.update(model, e.parallel);
  const std::vector<std::uint32_t> affected = model.tied_bodies(std::array{body});
  const std::uint32_t articulate = model.bodies[body].articulate;
  e.islands.put_to_rest(model, articulate);
  for (const std::uint32_t b : affected) {
    model::Articulate& a = model.articulates[model.bodies[b].articulate];
    a.to_wake = a.velocity_dirty = 0;
  }
}

}  // namespace

void apply(Editor& e, const SetKind& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.body);
  const BodyKind before = model.bodies[slot].kind;
  if (before == c.kind) return;
  if (c.kind != BodyKind::static_ && c.kind != BodyKind::inactive) refuse_obstacle(model, slot, "move");
  if (c.kind == BodyKind::resting) {
    if (before != BodyKind::dynamic)
      throw std::invalid_argument(text("only dynamic bodies can rest; body ", slot, " is not: make it dynamic first"));
    return put_to_rest(e, slot);
  }
  if (model::is_free(c.kind) && lacks_volume(model, slot))
    throw std::invalid_argument(
        text("body ", slot, " is a half-space or an open mesh, which has no mass: it can only be static or scripted"));
  if (before == BodyKind::resting) {
    for (const std::uint32_t b : model.tied_bodies(std::array{slot})) {
      if (model.bodies[b].kind == BodyKind::resting) model.bodies[b].kind = BodyKind::dynamic;
      model.wake(model.bodies[b].articulate);
    }
    e.islands.free_bodies().note_change();
    if (c.kind == BodyKind::dynamic) return;
  }
  const auto change = [&] {
    model::Body& body = model.bodies[slot];
    if (c.kind == BodyKind::inactive) body.kind_before = body.kind;
    body.kind = c.kind;
    if (c.kind != BodyKind::scripted) stop_carrying(e, slot);
    if (c.kind != BodyKind::dynamic) model.spins.erase(slot);
    if (c.kind == BodyKind::dynamic && before != BodyKind::inactive) model.rebuild_basis(slot);  // rigid here
    model.for_each_particle_of(slot, [&](std::uint32_t p) {
      model.acting_changed(p);
      const std::uint32_t ring = model.particles[p].ring;
      if (c.kind != BodyKind::dynamic && (c.kind != BodyKind::inactive || model.rings[ring].count == 1))
        model.stop_ring(ring);
    });
    model.mark_body(slot);
    model.mark_velocities(body.articulate);
  };
  if (before == BodyKind::inactive) {  // the bodies hinged to it may have moved meanwhile
    RestructureReport report;
    Restructuring restored(e, {{slot}}, Restructuring::Kind::moving, report);
    change();
    report.changed = true;
    restored.finish({true, true});
    return;
  }
  change();
  e.structure_changed();
}

void apply(Editor& e, const SetRadius& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_size("radius", c.value);
  if (model.bodies[body].first_solid != none)
    throw std::invalid_argument(text("body ", body, " is given by shape: its outline is that, and it has no radius"));
  const double before = radius_of(model, body);
  set_radius(model, body, c.value);
  if (c.value != before && model.material(body)) ingredient::Contacts::wake(model, body);
}

void apply(Editor& e, const SetColor& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  if (c.value > 0xffffff) throw std::invalid_argument(text("color must be at most 0xffffff, not ", c.value));
  if (c.has_one)
    model.colors.make(body) = c.value;
  else
    model.colors.erase(body);
  model.note_body(body);
}

void apply(Editor& e, const SetMaterial& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_material(c.value);
  const Material* const old = model.material(body);
  const bool had_one = old != nullptr;
  const Material before = old ? *old : Material{};
  if (c.touches)
    model.materials.make(body) = c.value;
  else
    model.materials.erase(body);
  const Material* const now = model.material(body);
  if (!c.touches || !now ||
      (had_one && (before.touches != now->touches || before.surface_velocity != now->surface_velocity)))
    ingredient::Contacts::end(model, body);  // it wakes what lies there
  ingredient::Contacts::wake(model, body);
  model.changed_outlines.note(body);
}

// --- motion -----------------------------------------------------------------------------------------------------------

void apply(Editor& e, const SetBodyDamping& c) {
  model::Model& model = e.model;
  require_not_negative("damping", c.per_second);
  const std::uint32_t body = e.require(c.body);
  model.set_damping(body, c.per_second);
  model.mark_locally(body);
}

namespace {

void require_particles(const model::Model& model, std::uint32_t body) {
  if (model.bodies[body].count == 0) throw std::invalid_argument(text("body ", body, " has no particles to move"));
}

template <class Motion>
void add_motion(Editor& e, std::uint32_t body, Motion motion) {
  model::Model& model = e.model;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model::Ring& ring = model.rings[model.particles[p].ring];
    ring.velocity += motion(ring.position);
  });
  e.mark_velocity_dirty(model.bodies[body].first);
}

}  // namespace

// Points on a line have no inertia about it, so they cannot keep such a spin. A rod has inertia.
void require_can_spin(const model::Model& model, std::uint32_t slot, const Vec3& spin) {
  constexpr double along = 1e-6;  // relative to the spin: round-off
  const model::Body& body = model.bodies[slot];
  if (body.rank > 2 || spin == Vec3{} || model.axial_inertia(slot) > 0) return;
  const Vec3 axis = model.position(body.basis[body.rank - 1]) - model.position(body.basis[0]);
  if (body.rank == 2 && std::abs(dot(spin, axis)) <= along * norm(spin) * norm(axis)) return;
  throw std::invalid_argument(
      text("set_angular_velocity: the particles of body ", slot,
           body.rank == 2 ? " are on one line, about which they have no inertia and cannot spin" : " are at one place",
           "; a body given by shape can, or a rod (set_rod)"));
}

void set_axial_spin(model::Model& model, std::uint32_t body, const Vec3& spin) {
  if (!(model.axial_inertia(body) > 0)) return;
  constexpr double round_off = 1e-12;
  const double axial = dot(spin, model.rod_axis(body));
  ingredient::RodSpins::set(model, body, std::abs(axial) > round_off * norm(spin) ? axial : 0);
}

// The whole articulate moves as a rigid body, so that joints are not violated.
void apply(Editor& e, const SetPose& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_finite("position", c.position);
  const Quaternion wanted = require_quaternion("orientation", c.orientation);
  const bool is_obstacle = model.obstacles.has(body);
  if (!is_obstacle) require_particles(model, body);
  // A scripted body wakes by its motion, so that what lies on one that is set to its place in each step may sleep.
  if (model.bodies[body].kind != BodyKind::scripted) ingredient::Contacts::wake(model, body);
  if (is_obstacle) {
    move_obstacle(model, body, {c.position, wanted});
    return e.orientations.forget();
  }
  e.orientations.refresh(e.model, std::span(&body, 1));
  const Quaternion& q = model.bodies[body].orientation;
  const Quaternion turn = multiply(wanted, {-q.x, -q.y, -q.z, q.w});
  const Vec3 center = model.center_of_mass(body);
  const auto moved = [&](const Vec3& x) { return c.position + rotate(turn, x - center); };
  const std::uint32_t articulate = model.bodies[body].articulate;
  if (model.bodies[body].kind == BodyKind::scripted) {
    // All before the first one moves, as attachments follow it: they came to twice as far.
    std::vector<std::pair<ParticleId, Vec3>> targets;
    model.for_each_particle_of(
        body, [&](std::uint32_t p) { targets.push_back({model.particles.id(p), moved(model.position(p))}); });
    for (const auto& [particle, target] : targets) carry(e, particle, target);
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
  sort_unique(rings);
  const Vec3 mean = (1 / mass) * momentum;  // velocities are turned too, which keeps kinetic energy
  for (const std::uint32_t slot : rings) {
    model::Ring& ring = model.rings[slot];
    ring.position = moved(ring.position);
    ring.velocity = mean + rotate(turn, ring.velocity - mean);
    // Also for a static body's rings, or its ties would bring it back.
    if (ingredient::Nail* const nail = model.nails.find(slot))
      nail->position = moved(nail->position), nail->position_before = moved(nail->position_before);
  }
  model.for_each_body_of(articulate, [&](std::uint32_t b) { refresh_coordinates_of(e, b); });
  model.bodies[body].orientation = wanted;
  e.orientations.forget();
  e.mark_velocity_dirty(model.bodies[body].first);
}

void apply(Editor& e, const SetBodyVelocity& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_finite("velocity", c.value);
  require_own_motion(model.bodies[body].kind, "velocity", c.value);
  require_particles(model, body);
  const Vec3 change = c.value - body_velocity(model, body);
  add_motion(e, body, [&](const Vec3&) { return change; });
}

void apply(Editor& e, const SetAngularVelocity& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_finite("angular velocity", c.value);
  require_own_motion(model.bodies[body].kind, "angular velocity", c.value);
  require_particles(model, body);
  require_can_spin(model, body, c.value);
  const Vec3 change = c.value - body_angular_velocity(model, body), center = model.center_of_mass(body);
  add_motion(e, body, [&](const Vec3& x) { return cross(change, x - center); });
  set_axial_spin(model, body, c.value);
}

// Its mass, momentum and energy are removed too.
void apply(Editor& e, const Destroy<BodyId>& c) {
  const std::uint32_t body = e.require(c.id);
  const ingredient::Attachments attachments(e.model, {{body}});
  destroy_body(e.model, body);
  attachments.reattach(e.model);
  e.structure_changed();
}

}  // namespace iota::edit
