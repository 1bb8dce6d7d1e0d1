// SPDX-License-Identifier: Apache-2.0
// What each command about constraints does; checks of what the user passes in.
#include "ingredient/joint_readings.h"
#include "ingredient/joint_rows.h"
#include "ingredient/loads.h"
#include "ingredient/quantities.h"
#include "step/checks.h"
#include "step/execute.h"

#include <cmath>

namespace iota {

using model::none;
using namespace ingredient;
using namespace step;

namespace {

void require_number(std::string_view name, double v) {
  if (!std::isfinite(v)) throw std::invalid_argument(text(name, " must be finite, got ", v));
}

const char* name_of(JointCoordinate which) {
  return std::array{"angle", "slide", "second angle"}[static_cast<std::size_t>(which)];
}

void require_options(std::string_view name, const CoordinateOptions& o) {
  if (!(o.lower <= o.upper))
    throw std::invalid_argument(text(name, " limits: lower must not be above upper, got ", o.lower, " and ", o.upper));
  if (o.lower == std::numeric_limits<double>::infinity() || o.upper == -std::numeric_limits<double>::infinity())
    throw std::invalid_argument(text(name, " limits leave no place, got ", o.lower, " and ", o.upper));
  require_number("motor_speed", o.motor_speed);
  if (!(o.motor_max >= 0)) throw std::invalid_argument(text("motor_max must be zero or more, got ", o.motor_max));
  require_not_negative("friction", o.friction);
  require_not_negative("stiffness", o.stiffness);
  require_not_negative("damping", o.damping);
  require_number("rest", o.rest);
}

void require_limits(const BreakLimits& limits) {
  for (const auto& [name, value] : {std::pair{"break_force", limits.force}, std::pair{"break_torque", limits.torque}})
    if (!(value > 0)) throw std::invalid_argument(text(name, " must be above zero, got ", value));
}

void require_surface(const model::PlacedSurface& surface) {
  require_finite("position of the surface", surface.position);
  const Quaternion& q = surface.orientation;
  const double size = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(std::abs(size - 1) < 1e-6))
    throw std::invalid_argument(
        text("orientation of the surface must be a unit quaternion x y z w, got length ", size));
}

/// Calls a surface's function once, for what would otherwise only show in the next step. point: world frame.
void require_function(const model::Model& model, const model::PlacedSurface& surface, const Vec3& point) {
  const auto found = model.surface_functions.find(surface.data.function);
  if (found == model.surface_functions.end()) return;
  const Quaternion& q = surface.orientation;
  const shape::FunctionSurface function(found->second.phi, found->second.size);
  (void)function.at(rotate({-q.x, -q.y, -q.z, q.w}, point - surface.position));
  if (!function.failure().empty())
    throw std::invalid_argument(text("the function of a surface ", function.failure(), ", at ", text_of(point)));
}

}  // namespace

std::uint32_t System::Implementation::require(ConstraintId id) const {
  if (!model.constraints.contains(id)) throw_stale("constraint", id, std::optional<ConstraintId>{});
  return id.slot;
}

void System::Implementation::constraint_changed(std::uint32_t constraint) {
  const model::Constraint& c = model.constraints[constraint];
  for (const int place : {model::a_origin, model::b_origin})
    if (c.particles[place] != none) model.touch_particle(c.particles[place]), jolt(c.particles[place]);
  structure_changed();
}

void System::Implementation::wake(std::uint32_t constraint) {
  for (const int side : {0, 1}) {
    const std::uint32_t body = body_of_side(model, model.constraints[constraint], side);
    if (body != none && model.bodies[body].kind == BodyKind::resting) return constraint_changed(constraint);
  }
}

ConstraintId System::Implementation::apply(const step::CreateJoint& c) {
  const model::ConstraintKindInfo& kind = model::info(c.spec.kind);
  if (kind.form != model::ConstraintKindInfo::Form::joint)
    throw std::invalid_argument(text("a ", kind.name, " joins two particles, not bodies"));
  (void)require(c.spec.a);
  if (c.spec.b) (void)require(c.spec.b);
  if (c.spec.a == c.spec.b)
    throw std::invalid_argument(text(kind.name, ": needs two bodies, got body ", c.spec.a.slot, " twice"));
  for (const BodyId body : {c.spec.a, c.spec.b})
    if (body && model.bodies[body.slot].count == 0)
      throw std::invalid_argument(text(kind.name, ": body ", body.slot, " has no particles"));
  require_finite("at", c.spec.at);
  for (const Vec3& axis : {c.spec.axis, c.spec.second_axis}) require_finite("axis", axis);
  if (!(norm(c.spec.axis) > 0)) throw std::invalid_argument("axis must have a direction, got zero length");
  const std::array options{&c.spec.angle, &c.spec.slide, &c.spec.second_angle};
  for (const JointCoordinate which : joint_coordinates) {
    const CoordinateOptions& o = *options[static_cast<std::size_t>(which)];
    require_options(name_of(which), o);
    if (!has_coordinate(c.spec.kind, which) && rows_of(o) != RowsOf{})
      throw std::invalid_argument(text("a ", kind.name, " joint has no ", name_of(which),
                                       " for limits, motors, friction or springs to act on"));
  }
  require_limits(c.spec.breaks);
  return made(make_constraint(model, c.spec));
}

ConstraintId System::Implementation::apply(const step::CreateDistance& c) {
  if (model::info(c.spec.kind).form != model::ConstraintKindInfo::Form::distance)
    throw std::invalid_argument(text("a ", model::info(c.spec.kind).name, " is no rod or rope"));
  (void)require(c.spec.p), (void)require(c.spec.q);
  require_limits(c.spec.breaks);
  return made(make_constraint(model, c.spec));
}

void System::Implementation::apply(const step::AddCurvePoints& c) {
  if (c.first) path_points.clear();
  path_points.insert(path_points.end(), c.points.begin(),
                     c.points.begin() + std::min<std::size_t>(c.count, c.points.size()));
}

ConstraintId System::Implementation::made(std::uint32_t slot) {
  ingredient::start_contact(model, slot);
  constraint_changed(slot);
  return model.constraints.id(slot);
}

ConstraintId System::Implementation::apply(const step::CreatePath& c) {
  const std::uint32_t particle = require(c.spec.particle);
  if (c.spec.body && require(c.spec.body) == model.particles[particle].body)
    throw std::invalid_argument(text("path: particle ", particle, " is of the body that holds the path"));
  for (const Vec3& point : path_points) require_finite("each point of the path", point);
  require_options("slide", c.spec.slide);
  require_limits(c.spec.breaks);
  return made(make_constraint(model, c.spec, path_points));
}

ConstraintId System::Implementation::apply(const step::CreateSurface& c) {
  const char* const name = model::info(c.spec.kind).name;
  if (model::info(c.spec.kind).form != model::ConstraintKindInfo::Form::surface)
    throw std::invalid_argument(text("a ", name, " is not between a particle and a surface"));
  const std::uint32_t particle = require(c.spec.particle);
  if (c.spec.body && require(c.spec.body) == model.particles[particle].body)
    throw std::invalid_argument(text(name, ": particle ", particle, " is of the body that holds the surface"));
  require_surface(c.spec.surface);
  require_function(model, c.spec.surface, model.position(particle));
  require_limits(c.spec.breaks);
  return made(make_constraint(model, c.spec));
}

ConstraintId System::Implementation::apply(const step::CreateSurfacePair& c) {
  const char* const name = model::info(c.spec.kind).name;
  if (model::info(c.spec.kind).form != model::ConstraintKindInfo::Form::surface_pair)
    throw std::invalid_argument(text("a ", name, " is not between two surfaces"));
  (void)require(c.spec.a);
  if (c.spec.b) (void)require(c.spec.b);
  if (c.spec.a == c.spec.b)
    throw std::invalid_argument(text(name, ": needs two bodies, got body ", c.spec.a.slot, " twice"));
  for (const model::PlacedSurface& surface : c.spec.surfaces) require_surface(surface);
  for (const std::size_t i : {0, 1}) require_function(model, c.spec.surfaces[i], c.spec.surfaces[1 - i].position);
  require_limits(c.spec.breaks);
  return made(make_constraint(model, c.spec));
}

void System::Implementation::apply(const step::SetConstraintActive& c) {
  const std::uint32_t slot = require(c.constraint);
  model::Constraint& constraint = model.constraints[slot];
  constraint.broken = 0;
  if (constraint.active == static_cast<std::uint8_t>(c.active)) return;
  constraint.active = c.active;
  if (c.active) model.make_geometry_anew(slot);  // a surface that has failed gets another chance
  ingredient::refresh_coordinates(model, slot);
  constraint.multipliers.fill(0), constraint.efforts = {}, constraint.gap = 0;
  constraint_changed(slot);
}

void System::Implementation::apply(const step::SetCoordinate& c) {
  const std::uint32_t slot = require(c.constraint);
  model::Constraint& constraint = model.constraints[slot];
  const model::ConstraintKindInfo& kind = model::info(constraint.kind);
  const char* const name = name_of(c.coordinate);
  if (!has_coordinate(constraint.kind, c.coordinate))
    throw std::invalid_argument(text("a ", kind.name, " has no ", name));
  require_options(name, c.options);
  CoordinateOptions& options = constraint.options[static_cast<std::size_t>(c.coordinate)];
  const bool same_rows = rows_of(options) == rows_of(c.options);
  options = c.options;
  if (same_rows) return wake(slot);
  const RowsOf rows = rows_of(options);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!rows[i]) constraint.efforts[static_cast<std::size_t>(c.coordinate)][i] = 0;
  constraint_changed(slot);
}

void System::Implementation::apply(const step::SetLength& c) {
  const std::uint32_t slot = require(c.constraint);
  if (model::info(model.constraints[slot].kind).form != model::ConstraintKindInfo::Form::distance)
    throw std::invalid_argument("only rods and ropes have a length");
  if (!(c.value > 1e-9 && c.value <= 1e9))
    throw std::invalid_argument(text("length must be between 1e-9 and 1e9 m, got ", c.value));
  model.constraints[slot].length = c.value;
  model.scene.constraints.note(slot);
  wake(slot);
}

void System::Implementation::apply(const step::SetBreakLimits& c) {
  const std::uint32_t slot = require(c.constraint);
  require_limits(c.limits);
  model.constraints[slot].breaks = c.limits;
}

void System::Implementation::apply(const step::SetBreakForce& c) {
  const std::uint32_t particle = require(c.particle);
  require_limits({.force = c.force});
  model.set_fuse(particle, c.force);
}

void System::Implementation::apply(const step::SetBondBreakForce& c) {
  const std::uint32_t bond = require(c.bond);
  require_limits({.force = c.force});
  model.bonds[bond].break_force = c.force;
  ++model.bonds_revision;
}

void System::Implementation::apply(const step::Destroy<ConstraintId>& c) {
  const std::uint32_t slot = require(c.id);
  if (!recording)
    for (const model::SurfaceData& surface : model.constraints[slot].surfaces)
      if (surface.function >= scripts_saved_below) model.surface_functions.erase(surface.function);
  destroy_constraint(model, slot);
  structure_changed();
}

void System::Implementation::switch_off_failed_surfaces(StepReport& report) {
  for (std::uint32_t slot = 0; slot < model.constraints.slot_count(); ++slot) {
    if (!model.constraints.is_alive(slot) || !model.constraints[slot].active) continue;
    for (const auto& surface : model.geometry(slot).surfaces) {
      if (!surface || surface->failure().empty()) continue;
      report.switched_off_constraints.push_back(model.constraints.id(slot));
      report.warnings.push_back(text("constraint ", slot, " (", model::info(model.constraints[slot].kind).name,
                                     "): the function of its surface ", surface->failure(),
                                     "; the constraint is switched off"));
      apply(SetConstraintActive{model.constraints.id(slot), false});
      break;
    }
  }
}

void System::Implementation::break_overloaded(StepReport& report) {
  for (std::uint32_t slot = 0; slot < model.constraints.slot_count(); ++slot) {
    if (!model.constraints.is_alive(slot)) continue;
    const model::Constraint& c = model.constraints[slot];
    if (!c.active || (std::isinf(c.breaks.force) && std::isinf(c.breaks.torque))) continue;
    const Reaction reaction = calc_reaction(model, slot);
    const double force = norm(reaction.force), torque = norm(reaction.torque);
    if (!(force > c.breaks.force || torque > c.breaks.torque)) continue;
    report.broken.push_back(
        {.constraint = model.constraints.id(slot), .position = reaction.position, .force = force, .torque = torque});
    ingredient::begin_edits(model);
    apply(SetConstraintActive{model.constraints.id(slot), false});
    model.constraints[slot].broken = 1;
    model.scene.note(ViewEvent::Kind::break_, reaction.position);
  }
  held_forces.update(model);
  for (const std::uint32_t slot : held_forces.breakable) {
    model::Bond& bond = model.bonds[slot];
    const double force = norm(bond_force(slot));
    if (!(force > bond.break_force)) continue;
    const Vec3 middle = 0.5 * (model.position(bond.p) + model.position(bond.q));
    report.broken.push_back({.bond = model.bonds.id(slot), .position = middle, .force = force});
    ingredient::begin_edits(model);
    apply(SetActive{model.bonds.id(slot), false});
    bond.broken = 1;
    model.scene.note(ViewEvent::Kind::break_, middle);
  }
  std::vector<Broken> overloaded;
  model.fuses.for_each([&](std::uint32_t particle, double most) {
    const double force = norm(calc_hinge_force(model, particle));
    if (force > most)
      overloaded.push_back(
          {.particle = model.particles.id(particle), .position = model.position(particle), .force = force});
  });
  if (!overloaded.empty()) ingredient::begin_edits(model);
  for (const Broken& broken : overloaded) {
    const model::Ring& ring = model.rings[model.particles[broken.particle.slot].ring];
    if (ring.count > 1)
      (void)apply(
          Separate{model.particles.id(ring.first == broken.particle.slot ? ring.last : ring.first), broken.particle});
    else if (ring.nailed)
      apply(Release{broken.particle});
    else
      continue;
    report.broken.push_back(broken);
  }
}

// --- the public edge --------------------------------------------------------------------------------------------------

model::PlacedSurface System::Implementation::placed(const Surface& surface) {
  model::PlacedSurface placed{{}, surface.position, surface.orientation};
  if (const auto* function = std::get_if<SurfaceFunction>(&surface.shape)) {
    if (!function->phi) throw std::invalid_argument("a function surface needs a function");
    placed.data.function = next_script++;
    model.surface_functions[placed.data.function] = *function;
  } else
    placed.data.shape = shape::to_data(std::get<Shape>(surface.shape));
  return placed;
}

template <class Specify>
ConstraintId System::Implementation::make_with_functions(Specify specify) {
  const std::uint64_t first = next_script;
  try {
    return execute(specify());
  } catch (...) {  // refused: nobody has its functions
    model.surface_functions.erase(model.surface_functions.lower_bound(first), model.surface_functions.end());
    throw;
  }
}

ConstraintId System::create_constraint(const JointSpec& spec) { return implementation_->execute(CreateJoint{spec}); }
ConstraintId System::create_constraint(const DistanceSpec& spec) {
  return implementation_->execute(CreateDistance{spec});
}
ConstraintId System::create_constraint(const PathSpec& spec) {
  for (std::size_t first = 0; first == 0 || first < spec.points.size(); first += 16) {
    AddCurvePoints lot{.points = {}, .count = 0, .first = first == 0};
    while (lot.count < 16 && first + lot.count < spec.points.size())
      lot.points[lot.count] = spec.points[first + lot.count], ++lot.count;
    implementation_->execute(lot);
  }
  return implementation_->execute(
      CreatePath{{spec.particle, spec.body, spec.curve, spec.closed, spec.rounding, spec.slide, spec.breaks}});
}
ConstraintId System::create_constraint(const SurfaceSpec& spec) {
  return implementation_->make_with_functions([&] {
    return CreateSurface{{spec.kind, spec.particle, spec.body, implementation_->placed(spec.surface), spec.breaks}};
  });
}
ConstraintId System::create_constraint(const SurfacePairSpec& spec) {
  return implementation_->make_with_functions([&] {
    return CreateSurfacePair{{spec.kind,
                              spec.a,
                              spec.b,
                              {implementation_->placed(spec.surface_a), implementation_->placed(spec.surface_b)},
                              spec.breaks}};
  });
}
void System::destroy(ConstraintId id) { implementation_->execute(step::Destroy<ConstraintId>{id}); }
void System::set_active(ConstraintId id, bool active) { implementation_->execute(SetConstraintActive{id, active}); }
void System::set_coordinate(ConstraintId id, JointCoordinate coordinate, const CoordinateOptions& options) {
  implementation_->execute(SetCoordinate{id, coordinate, options});
}
void System::set_length(ConstraintId id, double value) { implementation_->execute(SetLength{id, value}); }
void System::set_break_limits(ConstraintId id, const BreakLimits& limits) {
  implementation_->execute(SetBreakLimits{id, limits});
}

const CoordinateOptions& System::coordinate(ConstraintId id, JointCoordinate coordinate) const {
  const model::Constraint& c = implementation_->model.constraints[implementation_->require(id)];
  return c.options[static_cast<std::size_t>(coordinate)];
}
void System::set_break_force(ParticleId id, double force) { implementation_->execute(SetBreakForce{id, force}); }
void System::set_break_force(BondId id, double force) { implementation_->execute(SetBondBreakForce{id, force}); }
double System::break_force(BondId id) const {
  return implementation_->model.bonds[implementation_->require(id)].break_force;
}
bool System::is_broken(BondId id) const { return implementation_->model.bonds[implementation_->require(id)].broken; }
double System::break_force(ParticleId id) const {
  const model::Model& m = implementation_->model;
  const double* const force = m.fuses.find(implementation_->require(id));
  return force ? *force : std::numeric_limits<double>::infinity();
}
Vec3 System::hinge_force(ParticleId id) const {
  return calc_hinge_force(implementation_->model, implementation_->require(id));
}
ConstraintState System::state(ConstraintId id) const {
  const model::Model& m = implementation_->model;
  const std::uint32_t slot = implementation_->require(id);
  const model::Constraint& c = m.constraints[slot];
  ConstraintState state;
  state.kind = c.kind;
  const auto body_id = [&](int side) {
    const std::uint32_t body = body_of_side(m, c, side);
    return body == none ? BodyId{} : m.bodies.id(body);
  };
  state.a = body_id(0), state.b = body_id(1);
  state.active = c.active, state.broken = c.broken;
  const Reaction reaction = calc_reaction(m, slot);
  state.position = reaction.position, state.force = reaction.force, state.torque = reaction.torque;
  for (const int axis : {model::a_axis, model::b_axis}) {
    if (!c.has(axis)) continue;
    const Vec3 d =
        position_of(m, c, axis) - position_of(m, c, axis < model::b_origin ? model::a_origin : model::b_origin);
    state.axis = (1 / norm(d)) * d;
    break;
  }
  state.gap = is_in_force(m, c) ? c.gap : 0, state.length = c.length;
  for (const JointCoordinate which : joint_coordinates) {
    const auto i = static_cast<std::size_t>(which);
    if (!has_coordinate(c.kind, which)) continue;
    std::tie(state.coordinate[i], state.speed[i]) = calc_coordinate(m, slot, which);
    for (const double multiplier : c.efforts[i]) state.effort[i] -= multiplier;
  }
  return state;
}
BreakLimits System::break_limits(ConstraintId id) const {
  return implementation_->model.constraints[implementation_->require(id)].breaks;
}
std::vector<ParticleId> System::particles(ConstraintId id) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  for (const std::uint32_t p : m.constraints[implementation_->require(id)].particles)
    if (p != none) ids.push_back(m.particles.id(p));
  return ids;
}
std::vector<ConstraintId> System::constraints() const { return implementation_->model.constraints.ids(); }
bool System::contains(ConstraintId id) const { return implementation_->model.constraints.contains(id); }

}  // namespace iota
