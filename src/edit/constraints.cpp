// SPDX-License-Identifier: Apache-2.0
#include "edit/constraints.h"

#include "ingredient/coupling_form.h"
#include "ingredient/distance_form.h"
#include "ingredient/joint_readings.h"
#include "ingredient/joint_rows.h"
#include "ingredient/pin_form.h"
#include "ingredient/strides.h"
#include "math/checks.h"
#include "math/mat3.h"
#include "shape/shape.h"

#include <cmath>
#include <utility>

namespace iota::edit {

using model::none;

namespace {

const char* name_of(JointCoordinate which) {
  return std::array{"angle", "slide", "second angle"}[static_cast<std::size_t>(which)];
}

void require_options(ConstraintKind of, JointCoordinate which, const CoordinateOptions& o) {
  const char* const name = name_of(which);
  if (!(o.lower <= o.upper))
    throw std::invalid_argument(text(name, " limits: lower must not be above upper, got ", o.lower, " and ", o.upper));
  if (o.lower == std::numeric_limits<double>::infinity() || o.upper == -std::numeric_limits<double>::infinity())
    throw std::invalid_argument(text(name, " limits leave no place, got ", o.lower, " and ", o.upper));
  if (std::isnan(o.servo) || std::isnan(o.motor_speed)) require_number("motor_speed", o.motor_speed);
  if (std::isinf(o.servo)) throw std::invalid_argument(text("servo must be finite, got ", o.servo));
  require_not_negative("servo_time", o.servo_time);
  if (!(o.motor_max >= 0)) throw std::invalid_argument(text("motor_max must be zero or more, got ", o.motor_max));
  require_not_negative("friction", o.friction);
  require_not_negative("friction_coefficient", o.friction_coefficient);
  require_not_negative("stiffness", o.stiffness);
  require_not_negative("damping", o.damping);
  require_number("rest", o.rest);
  const ingredient::ConstraintKindInfo& kind = ingredient::info(of);
  if (o.friction_coefficient > 0 && !(which == JointCoordinate::slide && kind.may_rub()))
    throw std::invalid_argument(text("the ", name, " of a ", kind.name,
                                     " constraint cannot have a friction coefficient; the slides of prismatic and "
                                     "cylindrical joints can"));
}

void require_limits(const BreakLimits& limits) {
  require_break_force(limits.force);
  require_break_force(limits.torque, "break_torque");
}

void require_surface(const ingredient::PlacedSurface& surface) {
  if (surface.data.function == 0) shape::check(shape::from_data(surface.data.shape));
  require_finite("position of the surface", surface.position);
  const Quaternion& q = surface.orientation;
  const double size = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(std::abs(size - 1) < 1e-6))
    throw std::invalid_argument(
        text("orientation of the surface must be a unit quaternion x y z w, got length ", size));
}

/// Calls a surface's function once, to find errors before the next step. point: world frame.
void require_function(const model::Model& model, const ingredient::PlacedSurface& surface, const Vec3& point) {
  const auto found = model.surface_functions.find(surface.data.function);
  if (found == model.surface_functions.end()) return;
  const Quaternion& q = surface.orientation;
  const shape::FunctionSurface function(found->second.phi, found->second.size);
  (void)function.at(rotate({-q.x, -q.y, -q.z, q.w}, point - surface.position));
  if (!function.failure().empty())
    throw std::invalid_argument(text("the function of a surface ", function.failure(), ", at ", text_of(point)));
}

/// visit(constraint): the terms of a coupling, or the constraint itself.
template <class Visit>
void for_each_joint_of(const model::Model& model, std::uint32_t constraint, Visit visit) {
  const ingredient::Constraint& c = model.constraints[constraint];
  if (c.first_term == none) visit(c);
  ingredient::joint::for_each_term(model, c,
                                   [&](const ingredient::CoupledTerm& term) { visit(model.constraints[term.joint]); });
}

/// Call it after making or changing a constraint: its island is rebuilt, its velocities are projected before the next
/// step, and a gap closes there.
void constraint_changed(Editor& e, std::uint32_t constraint) {
  model::Model& model = e.model;
  for_each_joint_of(model, constraint, [&](const ingredient::Constraint& c) {
    for (const int place : {ingredient::a_origin, ingredient::b_origin})
      if (c.particles[place] != none)
        model.mark_locally(model.particles[c.particles[place]].body), e.mark_velocity_dirty(c.particles[place]);
  });
  e.structure_changed();
}

/// Wakes resting bodies that a changed motor or rope must move.
void wake(Editor& e, std::uint32_t constraint) {
  model::Model& model = e.model;
  bool rests = false;
  for_each_joint_of(model, constraint, [&](const ingredient::Constraint& c) {
    for (const int side : {0, 1})
      if (const std::uint32_t body = body_of_side(model, c, side); body != none)
        rests = rests || model.bodies[body].kind == BodyKind::resting;
  });
  if (rests) constraint_changed(e, constraint);
}

/// Bodies jump where a new stop, rope, rod, path, surface or coupling asks for it.
void note_jump(model::Model& model, std::uint32_t slot) {
  constexpr double far = 1e-6, far_from_surface = 1e-3;  // relative
  const ingredient::Constraint& c = model.constraints[slot];
  const char* const kind = ingredient::info(c.kind).name;
  const auto form = ingredient::info(c.kind).form;
  if (c.kind == ConstraintKind::rope || c.kind == ConstraintKind::rod) {
    const double distance =
        norm(position_of(model, c, ingredient::a_origin) - position_of(model, c, ingredient::b_origin));
    const bool is_short = distance > (1 + far) * c.length;
    if (is_short || (c.kind == ConstraintKind::rod && distance < (1 - far) * c.length))
      model.notes.push_back(text(kind, " ", slot, " is ", c.length, " m long and its ends are ", distance,
                                 " m apart: the next step moves them ", is_short ? "together" : "apart"));
  }
  using Form = ingredient::ConstraintKindInfo::Form;
  // Others hold where they are made.
  if (form != Form::pin && form != Form::distance &&
      ingredient::calc_violation(model, slot).relative > far_from_surface)
    model.notes.push_back(text(kind, " ", slot, " does not hold yet: the next step moves its bodies until it does"));
  for (const JointCoordinate which : joint_coordinates) {
    const CoordinateOptions& o = c.options[static_cast<std::size_t>(which)];
    if (!has_coordinate(c.kind, which) || !(o.lower <= o.upper)) continue;
    const double now = c.coordinate[static_cast<std::size_t>(which)], slack = far * std::max(1.0, std::abs(now));
    if (now < o.lower - slack || now > o.upper + slack)
      model.notes.push_back(text("the ", name_of(which), " of ", kind, " ", slot, " is ", now,
                                 ", outside of its limits ", o.lower, " to ", o.upper,
                                 ": the next step moves its bodies there"));
  }
}

ConstraintId made(Editor& e, std::uint32_t slot) {
  model::Model& model = e.model;
  ingredient::start_rows(model, slot);
  note_jump(model, slot);
  constraint_changed(e, slot);
  return model.constraints.id(slot);
}

}  // namespace

void refresh_coordinates_of(Editor& e, std::uint32_t body) {
  model::Model& model = e.model;
  if (model.constraints.size() == 0) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.for_each_constraint_of(p, [&](std::uint32_t c, int) {
      if (e.batch) e.batch->note_coordinates(model, c);
      ingredient::refresh_coordinates(model, c);
    });
  });
}

ConstraintId apply(Editor& e, const CreateJoint& c) {
  model::Model& model = e.model;
  const ingredient::ConstraintKindInfo& kind = ingredient::info(c.spec.kind);
  if (kind.form != ingredient::ConstraintKindInfo::Form::pin)
    throw std::invalid_argument(text("a ", kind.name, " joins two particles, not bodies"));
  (void)e.require(c.spec.a);
  if (c.spec.b) (void)e.require(c.spec.b);
  if (c.spec.a == c.spec.b)
    throw std::invalid_argument(text(kind.name, ": needs two bodies, got body ", c.spec.a.slot, " twice"));
  for (const BodyId body : {c.spec.a, c.spec.b})
    if (body && model.bodies[body.slot].count == 0)
      throw std::invalid_argument(text(kind.name, ": body ", body.slot, " has no particles"));
  require_finite("at", c.spec.at);
  for (const Vec3& axis : {c.spec.axis, c.spec.second_axis}) require_finite("axis", axis);
  if (!(norm(c.spec.axis) > 0)) throw std::invalid_argument("axis must have a direction, got zero length");
  if (c.spec.kind == ConstraintKind::screw) {
    require_number("lead", c.spec.lead);
    if (c.spec.lead == 0) throw std::invalid_argument("a screw needs a lead that is not zero; use a revolute joint");
  }
  const std::array options{&c.spec.angle, &c.spec.slide, &c.spec.second_angle};
  for (const JointCoordinate which : joint_coordinates) {
    const CoordinateOptions& o = *options[static_cast<std::size_t>(which)];
    require_options(c.spec.kind, which, o);
    if (!has_coordinate(c.spec.kind, which) && ingredient::rows_of(o) != ingredient::RowsOf{})
      throw std::invalid_argument(text("a ", kind.name, " joint has no ", name_of(which),
                                       " for limits, motors, friction or springs to act on"));
  }
  require_limits(c.spec.breaks);
  return made(e, make_constraint(model, c.spec));
}

ConstraintId apply(Editor& e, const CreateDistance& c) {
  if (ingredient::info(c.spec.kind).form != ingredient::ConstraintKindInfo::Form::distance)
    throw std::invalid_argument(text("a ", ingredient::info(c.spec.kind).name, " is not a rod or rope"));
  (void)e.require(c.spec.p), (void)e.require(c.spec.q);
  require_limits(c.spec.breaks);
  return made(e, make_constraint(e.model, c.spec));
}

ConstraintId apply(Editor& e, const CreatePath& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.spec.particle);
  if (c.spec.body && e.require(c.spec.body) == model.particles[particle].body)
    throw std::invalid_argument(text("path: particle ", particle, " is of the body that holds the path"));
  for (const Vec3& point : c.spec.points) require_finite("each point of the path", point);
  require_number("rounding", c.spec.rounding);
  require_options(ConstraintKind::path, JointCoordinate::slide, c.spec.slide);
  require_limits(c.spec.breaks);
  return made(e, make_constraint(model, c.spec));
}

ConstraintId apply(Editor& e, const CreateSurface& c) {
  model::Model& model = e.model;
  const char* const name = ingredient::info(c.spec.kind).name;
  if (ingredient::info(c.spec.kind).form != ingredient::ConstraintKindInfo::Form::surface)
    throw std::invalid_argument(text("a ", name, " is not between a particle and a surface"));
  const std::uint32_t particle = e.require(c.spec.particle);
  if (c.spec.body && e.require(c.spec.body) == model.particles[particle].body)
    throw std::invalid_argument(text(name, ": particle ", particle, " is of the body that holds the surface"));
  require_surface(c.spec.surface);
  require_function(model, c.spec.surface, model.position(particle));
  require_limits(c.spec.breaks);
  return made(e, make_constraint(model, c.spec));
}

ConstraintId apply(Editor& e, const CreateSurfacePair& c) {
  model::Model& model = e.model;
  const char* const name = ingredient::info(c.spec.kind).name;
  if (ingredient::info(c.spec.kind).form != ingredient::ConstraintKindInfo::Form::surface_pair)
    throw std::invalid_argument(text("a ", name, " is not between two surfaces"));
  (void)e.require(c.spec.a);
  if (c.spec.b) (void)e.require(c.spec.b);
  if (c.spec.a == c.spec.b)
    throw std::invalid_argument(text(name, ": needs two bodies, got body ", c.spec.a.slot, " twice"));
  for (const ingredient::PlacedSurface& surface : c.spec.surfaces) require_surface(surface);
  for (const std::size_t i : {0, 1}) require_function(model, c.spec.surfaces[i], c.spec.surfaces[1 - i].position);
  require_limits(c.spec.breaks);
  return made(e, make_constraint(model, c.spec));
}

ConstraintId apply(Editor& e, const CreateSpan& c) {
  (void)e.require(c.spec.p), (void)e.require(c.spec.q);
  if (c.spec.p == c.spec.q)
    throw std::invalid_argument(text("span: needs two particles, got particle ", c.spec.p.slot, " twice"));
  require_options(ConstraintKind::span, JointCoordinate::slide, c.spec.slide);
  require_limits(c.spec.breaks);
  return made(e, make_constraint(e.model, c.spec));
}

ConstraintId apply(Editor& e, const CreateCoupling& c) {
  model::Model& model = e.model;
  if (ingredient::info(c.spec.kind).form != ingredient::ConstraintKindInfo::Form::coupling)
    throw std::invalid_argument(text("a ", ingredient::info(c.spec.kind).name, " does not couple coordinates"));
  const char* const name = ingredient::info(c.spec.kind).name;
  if (c.spec.terms.empty()) throw std::invalid_argument(text(name, ": needs at least one coordinate"));
  for (const CoupledCoordinate& term : c.spec.terms) {
    const std::uint32_t joint = e.require(term.constraint);
    const ConstraintKind kind = model.constraints[joint].kind;
    if (model.constraints[joint].is_part)
      throw std::invalid_argument(text(name, ": span ", joint, " is part of a rope; make a span of your own"));
    if (!has_coordinate(kind, term.coordinate))
      throw std::invalid_argument(text("a ", ingredient::info(kind).name, " has no ", name_of(term.coordinate)));
    if (!ingredient::has_coordinate_row(model, joint, term.coordinate))
      throw std::invalid_argument(text(name, ": the bodies of ", ingredient::info(kind).name, " ", joint,
                                       " are too thin to have its ", name_of(term.coordinate),
                                       "; give them a massive particle off their line"));
    require_number("ratio", term.ratio);
    for (const CoupledCoordinate* other = c.spec.terms.data(); other != &term; ++other)
      if (other->constraint == term.constraint && other->coordinate == term.coordinate)
        throw std::invalid_argument(text(name, ": names the ", name_of(term.coordinate), " of ",
                                         ingredient::info(kind).name, " ", joint, " twice; add up its ratios"));
    if (term.ratio == 0) throw std::invalid_argument("a ratio of zero leaves its coordinate out; leave it out");
  }
  if (!std::isnan(c.spec.length)) require_number("length", c.spec.length);
  require_limits(c.spec.breaks);
  if (c.spec.terms.size() == 1 && c.spec.kind == ConstraintKind::coupling && std::isnan(c.spec.length))
    throw std::invalid_argument(text(name,
                                     ": couples two or more coordinates, and would lock a single one; give it a length "
                                     "if you want that, or the coordinate limits or a servo"));
  return made(e, make_constraint(model, c.spec));
}

ConstraintId apply(Editor& e, const CreateTackle& c) {
  const std::vector<ParticleId>& points = c.spec.points;
  if (points.size() < 2) throw std::invalid_argument("rope: needs at least two points");
  for (const ParticleId p : points) (void)e.require(p);
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    if (points[i] == points[i + 1])
      throw std::invalid_argument(text("rope: point ", i, " and the next are the same particle, ", points[i].slot));
  if (!std::isnan(c.spec.length) && !(c.spec.length > 1e-9 && c.spec.length <= 1e9))
    throw std::invalid_argument(text("rope: length must be between 1e-9 and 1e9 m, got ", c.spec.length));
  require_limits(c.spec.breaks);
  return made(e, make_constraint(e.model, c.spec));
}

void apply(Editor& e, const SetConstraintActive& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.constraint);
  ingredient::Constraint& constraint = model.constraints[slot];
  constraint.broken = 0;
  if (constraint.active == static_cast<std::uint8_t>(c.active)) return;
  constraint.active = c.active;
  if (c.active) ingredient::Joints::renew_geometry(model, slot);  // a failed surface is tried again
  ingredient::refresh_coordinates(model, slot);
  constraint.multipliers.fill(0), constraint.efforts = {}, constraint.carries = {}, constraint.gap = 0;
  constraint_changed(e, slot);
}

void apply(Editor& e, const SetCoordinate& c) {
  const std::uint32_t slot = e.require(c.constraint);
  ingredient::Constraint& constraint = e.model.constraints[slot];
  const ingredient::ConstraintKindInfo& kind = ingredient::info(constraint.kind);
  const char* const name = name_of(c.coordinate);
  if (!has_coordinate(constraint.kind, c.coordinate))
    throw std::invalid_argument(text("a ", kind.name, " has no ", name));
  require_options(constraint.kind, c.coordinate, c.options);
  if (c.options.friction_coefficient > 0 && !constraint.compliance.is_exact())
    throw std::invalid_argument("a joint with a compliance cannot have a friction coefficient; make it exact before");
  CoordinateOptions& options = constraint.options[static_cast<std::size_t>(c.coordinate)];
  const bool same_line = (options.friction_coefficient > 0) == (c.options.friction_coefficient > 0);
  const bool same_rows = ingredient::rows_of(options) == ingredient::rows_of(c.options) && same_line;
  options = c.options;
  note_jump(e.model, slot);
  if (same_rows) return wake(e, slot);
  if (!same_line) constraint.multipliers.fill(0);  // other rows than those of its line follow it
  const ingredient::RowsOf rows = ingredient::rows_of(options);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!rows[i]) constraint.efforts[static_cast<std::size_t>(c.coordinate)][i] = 0;
  if (!rows[0]) constraint.carries.set(1 + static_cast<int>(c.coordinate), false);
  constraint_changed(e, slot);
}

void apply(Editor& e, const SetLength& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.constraint);
  const ConstraintKind kind = model.constraints[slot].kind;
  if (kind == ConstraintKind::coupling)
    require_number("length", c.value);
  else if (kind != ConstraintKind::rod && kind != ConstraintKind::rope && kind != ConstraintKind::tackle)
    throw std::invalid_argument(
        text("a ", ingredient::info(kind).name, " has no length; rods, ropes and couplings have"));
  else if (!(c.value > 1e-9 && c.value <= 1e9))
    throw std::invalid_argument(text("length must be between 1e-9 and 1e9 m, got ", c.value));
  constexpr double most = 0.1;  // of the length: a winch changes it by less in each step
  constexpr double met = 1e-6;
  ingredient::Constraint& constraint = model.constraints[slot];
  const double before = std::exchange(constraint.length, c.value), way = c.value - (before - constraint.way);
  const bool is_line = kind == ConstraintKind::rod || kind == ConstraintKind::rope;
  const double size =
      kind == ConstraintKind::coupling ? ingredient::joint::CouplingForm::size_of(model, constraint) : c.value;
  const bool is_jump = std::abs(way) > most * size;
  // In a conflict the old length was not reached: what ran on from there would do work on no motion.
  const bool is_met = constraint.gap <= met * size;
  const bool runs = !is_jump && is_met && !constraint.is_new && constraint.active;
  constraint.way = runs ? way : 0;
  if (is_jump) note_jump(model, slot);
  model.changed_constraints.note(slot);
  for_each_joint_of(model, slot, [&](const ingredient::Constraint& joint) {
    for (const int side : {0, 1})
      if (const std::uint32_t body = body_of_side(model, joint, side); body != none)
        ingredient::Strides::disturb(model, body);
  });
  if (is_line && runs && !constraint.is_hauled) {
    constraint.is_hauled = 1;
    return constraint_changed(e, slot);
  }
  // The multiplier is the tension in parts of |d| / L.
  if (is_line && !ingredient::joint::DistanceForm::has_span(constraint)) constraint.multipliers[0] *= c.value / before;
  wake(e, slot);
}

void apply(Editor& e, const SetBreakLimits& c) {
  const std::uint32_t slot = e.require(c.constraint);
  require_limits(c.limits);
  e.model.constraints[slot].breaks = c.limits;
}

void apply(Editor& e, const SetCompliance& c) {
  const std::uint32_t slot = e.require(c.constraint);
  ingredient::Constraint& constraint = e.model.constraints[slot];
  const ingredient::ConstraintKindInfo& kind = ingredient::info(constraint.kind);
  require_not_negative("linear compliance", c.compliance.linear);
  require_not_negative("angular compliance", c.compliance.angular);
  require_not_negative("relaxation time", c.compliance.time);
  if (!c.compliance.is_exact() && !kind.may_yield())
    throw std::invalid_argument(
        text("a ", kind.name, " is always exact; joints, rods and ropes may have a compliance"));
  if (!c.compliance.is_exact() && ingredient::joint::PinForm::rubs(constraint))
    throw std::invalid_argument(
        "a joint with a friction coefficient cannot have a compliance; set the coefficient to 0 before");
  const bool same_rows = constraint.compliance.is_exact() == c.compliance.is_exact();
  constraint.compliance = c.compliance;
  same_rows ? wake(e, slot) : constraint_changed(e, slot);
}

void apply(Editor& e, const Destroy<ConstraintId>& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.id);
  for (const ingredient::SurfaceData& surface : model.constraints[slot].surfaces)
    e.drop_function(model.surface_functions, surface.function);
  ingredient::Joints::destroy(model, slot);
  e.structure_changed();
}

}  // namespace iota::edit
