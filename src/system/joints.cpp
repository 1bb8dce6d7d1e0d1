// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_readings.h"
#include "ingredient/joint_rows.h"
#include "system/core.h"

#include <algorithm>
#include <tuple>

namespace iota {

namespace {

/// A surface as plain data; its function, if any, is kept under the next key.
ingredient::PlacedSurface place(Core& core, const Surface& surface) {
  ingredient::PlacedSurface placed{{}, surface.position, surface.orientation};
  if (const auto* shape = std::get_if<Shape>(&surface.shape)) {
    placed.data.shape = shape::to_data(*shape);
    return placed;
  }
  const SurfaceFunction& function = std::get<SurfaceFunction>(surface.shape);
  if (!function.phi) throw std::invalid_argument("a function surface needs a function");
  placed.data.function = core.held.functions.next_key++;
  core.model.surface_functions[placed.data.function] = function;
  return placed;
}

/// The frame in which a side of a constraint has its curve or surface, in the world.
struct SideFrame {
  Vec3 origin, x, y, z;
};

SideFrame frame_of(const model::Model& m, const ingredient::Constraint& c, int side) {
  using namespace ingredient;
  const bool is_b = side == 1;
  const Vec3 origin = position_of(m, c, is_b ? b_origin : a_origin);
  const auto direction = [&](int place) { return (1 / c.scale[side]) * (position_of(m, c, place) - origin); };
  return {origin, direction(is_b ? b_side : a_side), direction(is_b ? b_third : a_third),
          direction(is_b ? b_axis : a_axis)};
}

template <class Specify>
ConstraintId create_with_functions(Core& core, Specify specify) {
  const std::uint64_t first = core.held.functions.next_key;
  try {
    return core.execute(specify());
  } catch (...) {  // refused: its functions are unused
    auto& functions = core.model.surface_functions;
    functions.erase(functions.lower_bound(first), functions.end());
    throw;
  }
}

}  // namespace

ConstraintId Joints::create(const JointSpec& spec) { return core_.execute(edit::CreateJoint{spec}); }

ConstraintId Joints::create(const DistanceSpec& spec) { return core_.execute(edit::CreateDistance{spec}); }

ConstraintId Joints::create(const PathSpec& spec) { return core_.execute(edit::CreatePath{spec}); }

ConstraintId Joints::create(const SurfaceSpec& spec) {
  return create_with_functions(core_, [&] {
    return edit::CreateSurface{{spec.kind, spec.particle, spec.body, place(core_, spec.surface), spec.breaks}};
  });
}

ConstraintId Joints::create(const SurfacePairSpec& spec) {
  return create_with_functions(core_, [&] {
    return edit::CreateSurfacePair{
        {spec.kind, spec.a, spec.b, {place(core_, spec.surface_a), place(core_, spec.surface_b)}, spec.breaks}};
  });
}

ConstraintId Joints::create(const SpanSpec& spec) { return core_.execute(edit::CreateSpan{spec}); }

ConstraintId Joints::create(const CouplingSpec& spec) { return core_.execute(edit::CreateCoupling{spec}); }

ConstraintId Joints::create(const TackleSpec& spec) { return core_.execute(edit::CreateTackle{spec}); }

void Joints::destroy(ConstraintId id) { core_.execute(edit::Destroy<ConstraintId>{id}); }

void Joints::set_active(ConstraintId id, bool active) { core_.execute(edit::SetConstraintActive{id, active}); }

void Joints::set_coordinate(ConstraintId id, JointCoordinate coordinate, const CoordinateOptions& options) {
  core_.execute(edit::SetCoordinate{id, coordinate, options});
}

void Joints::set_value(ConstraintId id, JointCoordinate coordinate, double value) {
  core_.execute(edit::SetCoordinateValue{id, coordinate, value});
}

void Joints::set_length(ConstraintId id, double value) { core_.execute(edit::SetLength{id, value}); }

void Joints::set_break_limits(ConstraintId id, const BreakLimits& limits) {
  core_.execute(edit::SetBreakLimits{id, limits});
}

Compliance Joints::compliance(ConstraintId id) const { return core_.model.constraints[core_.slot(id)].compliance; }

void Joints::set_compliance(ConstraintId id, const Compliance& compliance) {
  core_.execute(edit::SetCompliance{id, compliance});
}

CoordinateOptions Joints::coordinate(ConstraintId id, JointCoordinate coordinate) const {
  const ingredient::Constraint& c = core_.model.constraints[core_.slot(id)];
  return c.options[static_cast<std::size_t>(coordinate)];
}

ConstraintState Joints::state(ConstraintId id) const {
  const model::Model& m = core_.model;
  const std::uint32_t slot = core_.slot(id);
  const ingredient::Constraint& c = m.constraints[slot];
  ConstraintState state;
  state.kind = c.kind;
  const auto body_id = [&](int side) {
    const std::uint32_t body = body_of_side(m, c, side);
    return body == model::none ? BodyId{} : m.bodies.id(body);
  };
  state.a = body_id(0), state.b = body_id(1);
  state.active = c.active, state.broken = c.broken;
  const ingredient::Reaction reaction = ingredient::calc_reaction(m, slot);
  state.position = reaction.position, state.force = reaction.force, state.torque = reaction.torque;
  state.axis = calc_axis(m, c);
  if (ingredient::info(c.kind).cross)
    state.second_axis =
        (1 / c.scale[1]) * (position_of(m, c, ingredient::b_axis) - position_of(m, c, ingredient::b_origin));
  state.gap = is_in_force(m, c) ? c.gap : 0, state.length = c.length;
  for (const JointCoordinate which : joint_coordinates) {
    const auto i = static_cast<std::size_t>(which);
    if (!has_coordinate(c.kind, which)) continue;
    std::tie(state.coordinate[i], state.speed[i]) = ingredient::calc_coordinate(m, slot, which);
    state.effort[i] = {-c.efforts[i][0], -c.efforts[i][1], -c.efforts[i][2], -c.efforts[i][3]};
    if (which == JointCoordinate::slide) state.effort[i].friction -= ingredient::friction_of_line(c);
  }
  return state;
}

BreakLimits Joints::break_limits(ConstraintId id) const { return core_.model.constraints[core_.slot(id)].breaks; }

std::vector<ParticleId> Joints::particles(ConstraintId id) const {
  const model::Model& m = core_.model;
  std::vector<ParticleId> ids;
  const auto list = [&](const ingredient::Constraint& c) {
    for (const std::uint32_t p : c.particles)
      if (p != model::none && std::find(ids.begin(), ids.end(), m.particles.id(p)) == ids.end())
        ids.push_back(m.particles.id(p));
  };
  const ingredient::Constraint& c = m.constraints[core_.slot(id)];
  list(c);
  ingredient::joint::for_each_term(m, c, [&](const ingredient::CoupledTerm& term) { list(m.constraints[term.joint]); });
  return ids;
}

std::vector<CoupledCoordinate> Joints::terms(ConstraintId id) const {
  const model::Model& m = core_.model;
  std::vector<CoupledCoordinate> terms;
  ingredient::joint::for_each_term(m, m.constraints[core_.slot(id)], [&](const ingredient::CoupledTerm& term) {
    terms.push_back({m.constraints.id(term.joint), term.coordinate, term.ratio});
  });
  return terms;
}

PathSpec Joints::path(ConstraintId id) const {
  const model::Model& m = core_.model;
  const ingredient::Constraint& c = m.constraints[core_.slot(id)];
  if (c.kind != ConstraintKind::path) throw std::invalid_argument("path: only a particle on a path has one");
  PathSpec spec;
  spec.particle = m.particles.id(c.particles[ingredient::a_origin]);
  if (const std::uint32_t body = body_of_side(m, c, 1); body != model::none) spec.body = m.bodies.id(body);
  spec.curve = c.curve.kind, spec.closed = c.curve.closed != 0, spec.rounding = c.curve.rounding;
  spec.slide = c.options[static_cast<std::size_t>(JointCoordinate::slide)], spec.breaks = c.breaks;
  const SideFrame b = frame_of(m, c, 1);
  for (std::uint32_t i = 0; i < c.curve.count; ++i) {
    const Vec3& p = m.curve_points[c.curve.first + i];
    spec.points.push_back(b.origin + p.x * b.x + p.y * b.y + p.z * b.z);
  }
  return spec;
}

std::vector<Surface> Joints::surfaces(ConstraintId id) const {
  const model::Model& m = core_.model;
  const ingredient::Constraint& c = m.constraints[core_.slot(id)];
  using Form = ingredient::ConstraintKindInfo::Form;
  const Form form = ingredient::info(c.kind).form;
  std::vector<Surface> found;
  if (form != Form::surface && form != Form::surface_pair) return found;
  for (int side = form == Form::surface ? 1 : 0; side < 2; ++side) {
    const SideFrame frame = frame_of(m, c, side);
    Surface surface{{}, frame.origin, from_axes(frame.x, frame.y, frame.z)};
    const ingredient::SurfaceData& data = c.surfaces[side];
    if (data.function == 0)
      surface.shape = shape::from_data(data.shape);
    else if (const auto function = m.surface_functions.find(data.function); function != m.surface_functions.end())
      surface.shape = function->second;
    found.push_back(std::move(surface));
  }
  return found;
}

std::vector<ConstraintId> Joints::ids() const { return core_.model.constraints.ids(); }

bool Joints::contains(ConstraintId id) const { return core_.model.constraints.contains(id); }

}  // namespace iota
