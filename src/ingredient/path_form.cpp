// SPDX-License-Identifier: Apache-2.0
#include "ingredient/path_form.h"

#include "ingredient/joint_frames.h"

#include <iota/constraints.h>

#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace iota::ingredient {

using namespace joint;

solver::CurveConstraint PathForm::curve_row(const JointArms& j) {
  solver::CurveConstraint row;
  j.place_in_frame(row);
  row.curve = j.geometry.curve.get();
  row.reference = 0.1 * j.c.length;
  return row;
}

solver::StationConstraint PathForm::station_row(const JointArms& j) {
  solver::StationConstraint row;
  j.place_in_frame(row);
  row.curve = j.geometry.curve.get();
  row.parameter = j.c.coordinate[slide];
  row.reference = 0.1 * j.c.length;
  return row;
}

namespace {

std::shared_ptr<const geometry::Curve> make_curve(const CurveData& curve, std::span<const Vec3> points) {
  if (curve.kind == CurveKind::polyline)
    return std::make_shared<geometry::Polyline>(points, curve.closed != 0, curve.rounding);
  return std::make_shared<geometry::Spline>(points, curve.closed != 0);
}

}  // namespace

void PathForm::make_geometry(const Model& model, const Constraint& c, ConstraintGeometry& made) {
  made.curve = make_curve(c.curve, {model.curve_points.data() + c.curve.first, c.curve.count});
}

std::uint32_t make_constraint(Model& model, const PathSpec& spec) {
  const Side b = spec.body ? Side(model, spec.body.slot) : Side();
  require_frame(info(ConstraintKind::path).name, b);
  Constraint c;
  c.kind = ConstraintKind::path;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  c.particles[a_origin] = spec.particle.slot;
  c.curve.kind = spec.curve, c.curve.closed = spec.closed, c.curve.rounding = spec.rounding;
  const Vec3 first = spec.points.empty() ? Vec3{} : spec.points.front();
  const Vec3 origin = b.is_world() ? first : model.center_of_mass(b.body);
  std::vector<Vec3> local = spec.points;
  for (Vec3& p : local) p -= origin;
  const auto curve = make_curve(c.curve, local);  // throws for bad points before any change
  make_frame(model, c, b, b_origin, origin, {});
  c.curve.first = static_cast<std::uint32_t>(model.curve_points.size());
  c.curve.count = static_cast<std::uint32_t>(local.size());
  model.curve_points.insert(model.curve_points.end(), local.begin(), local.end());
  c.options[1] = spec.slide;
  if (!spec.closed && std::isinf(spec.slide.lower) && std::isinf(spec.slide.upper))
    c.options[1].lower = 0, c.options[1].upper = curve->length();
  c.length = curve->length();
  c.coordinate[1] = curve->nearest(model.position(spec.particle.slot) - origin);
  return Joints::add(model, c);
}

}  // namespace iota::ingredient
