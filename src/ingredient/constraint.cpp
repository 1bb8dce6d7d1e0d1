// SPDX-License-Identifier: Apache-2.0
#include "ingredient/constraint.h"

#include "ingredient/joint_forms.h"
#include "ingredient/model.h"

namespace iota::ingredient {

ConstraintGeometry make_geometry(const Model& model, const Constraint& c) {
  ConstraintGeometry made;
  joint::with_form(c.kind, [&]<class F>() { F::make_geometry(model, c, made); });
  return made;
}

std::uint32_t body_of_side(const Model& model, const Constraint& c, int side) {
  if (c.first_term != none) {
    std::uint32_t term = c.first_term;
    while (side == 1 && model.coupled_terms[term].next != none) term = model.coupled_terms[term].next;
    return body_of_side(model, model.constraints[model.coupled_terms[term].joint], 0);
  }
  const std::uint32_t origin = c.particles[side == 0 ? a_origin : b_origin];
  return origin == none ? none : model.particles[origin].body;
}

bool is_in_force(const Model& model, const Constraint& c) {
  bool complete = c.active, moves = false;
  const auto look_at = [&](const Constraint& joint) {
    complete = complete && joint.active;
    for (const int side : {0, 1}) {
      const std::uint32_t body = body_of_side(model, joint, side);
      if (body == none) continue;
      complete = complete && model.bodies[body].kind != BodyKind::inactive;
      moves = moves || is_free(model.bodies[body].kind);
    }
  };
  if (c.first_term == none) look_at(c);
  joint::for_each_term(model, c, [&](const CoupledTerm& term) { look_at(model.constraints[term.joint]); });
  return complete && moves;
}

Vec3 calc_axis(const Model& model, const Constraint& c) {
  for (const int axis : {a_axis, b_axis}) {
    if (!c.has(axis)) continue;
    const Vec3 d = position_of(model, c, axis) - position_of(model, c, axis < b_origin ? a_origin : b_origin);
    return (1 / norm(d)) * d;
  }
  return {};
}

Vec3 position_of(const Model& model, const Constraint& c, int place) {
  return c.particles[place] == none ? c.fixed[place - b_origin] : model.position(c.particles[place]);
}

}  // namespace iota::ingredient

namespace iota {

bool has_coordinate(ConstraintKind kind, JointCoordinate coordinate) {
  const ingredient::ConstraintKindInfo& i = ingredient::info(kind);
  return std::array{i.angle, i.slide, i.second_angle}[static_cast<std::size_t>(coordinate)];
}

}  // namespace iota
