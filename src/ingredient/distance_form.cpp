// SPDX-License-Identifier: Apache-2.0
#include "ingredient/distance_form.h"

#include "ingredient/joint_frames.h"

#include <iota/constraints.h>

#include <cmath>
#include <sstream>
#include <string>

namespace iota::ingredient {

using namespace joint;

bool DistanceForm::joins_nodes(const JointArms& j) {
  const auto single = [&](int place) {
    return j.places[place].nodes[0].second == 1 && j.places[place].constant == Vec3{};
  };
  return single(a_origin) && single(b_origin) && j.places[a_origin].nodes[0].first != j.places[b_origin].nodes[0].first;
}

solver::SpanConstraint DistanceForm::span_row(const JointArms& j) {
  solver::SpanConstraint row;
  j.sides(row, {a_origin}, {b_origin});
  j.add(row, 0, a_origin, 1), j.add(row, 0, b_origin, -1);
  row.reference = j.c.scale[0];
  return row;
}

solver::DistanceConstraint DistanceForm::rod_row(const JointArms& j) {
  return {{j.places[a_origin].nodes[0].first, j.places[b_origin].nodes[0].first}, j.c.length, j.c.length};
}

solver::BilinearConstraint DistanceForm::square_row(const JointArms& j) {
  solver::BilinearConstraint row;
  j.sides(row, {a_origin}, {b_origin});
  for (const int arm : {0, 1}) j.add(row, arm, a_origin, 1), j.add(row, arm, b_origin, -1);
  set_length(row, j.c.length);
  return row;
}

void DistanceForm::set_length(solver::BilinearConstraint& row, double length) {
  row.product = length * length, row.scale = 2 * length, row.reference = length;
}

std::uint32_t make_constraint(Model& model, const DistanceSpec& spec) {
  const char* const name = info(spec.kind).name;
  const std::uint32_t p = spec.p.slot, q = spec.q.slot;
  if (model.particles[p].body == model.particles[q].body)
    cannot(name, "particles " + std::to_string(p) + " and " + std::to_string(q) +
                     " are of one rigid body, whose distances never change");
  const double distance = norm(model.position(q) - model.position(p));
  Constraint c;
  c.kind = spec.kind;
  c.length = std::isnan(spec.length) ? distance : spec.length;
  if (!(c.length > 1e-9 && c.length <= 1e9)) {
    std::ostringstream got;
    got << c.length;
    cannot(name, "length must be between 1e-9 and 1e9 m, got " + got.str());
  }
  if (spec.kind == ConstraintKind::rod && are_on_one_ring(model, p, q))
    cannot(name, "particles " + std::to_string(p) + " and " + std::to_string(q) + " are hinged to each other");
  c.breaks = spec.breaks;
  c.scale = {c.length, c.length};
  c.particles.fill(none);
  c.particles[a_origin] = p, c.particles[b_origin] = q;
  return Joints::add(model, c);
}

std::uint32_t make_constraint(Model& model, const SpanSpec& spec) {
  Constraint c;
  c.kind = ConstraintKind::span;
  c.options[static_cast<std::size_t>(JointCoordinate::slide)] = spec.slide;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  c.particles[a_origin] = spec.p.slot, c.particles[b_origin] = spec.q.slot;
  const double distance = norm(model.position(spec.q.slot) - model.position(spec.p.slot));
  c.coordinate[static_cast<std::size_t>(JointCoordinate::slide)] = distance;
  c.scale.fill(distance > 0 ? distance : 1);
  return Joints::add(model, c);
}

}  // namespace iota::ingredient
