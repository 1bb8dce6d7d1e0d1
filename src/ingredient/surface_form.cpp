// SPDX-License-Identifier: Apache-2.0
#include "ingredient/surface_form.h"

#include "ingredient/joint_frames.h"
#include "shape/shape.h"

#include <algorithm>
#include <array>
#include <memory>

namespace iota::ingredient {

using namespace joint;

solver::SurfaceConstraint SurfaceForm::surface_row(const JointArms& j) {
  solver::SurfaceConstraint row;
  j.place_in_frame(row);
  row.surface = j.geometry.surfaces[1].get();
  return row;
}

solver::SurfacePairConstraint SurfacePairForm::pair_row(const JointArms& j) {
  solver::SurfacePairConstraint row;
  j.sides(row, {a_origin, a_axis, a_side, a_third}, {b_origin, b_axis, b_side, b_third});
  j.add(row, 0, b_origin, 1), j.add(row, 0, a_origin, -1);
  j.frame(row, 1, a_origin), j.frame(row, 4, b_origin);
  row.surface_a = j.geometry.surfaces[0].get(), row.surface_b = j.geometry.surfaces[1].get();
  row.reference = std::min(row.surface_a->scale(), row.surface_b->scale());
  row.nearest = j.c.nearest;
  return row;
}

void SurfacePairForm::start(Model& model, std::uint32_t slot) {
  Constraint& c = model.constraints[slot];
  const JointPlaces places(model, c);
  solver::SurfacePairConstraint row = pair_row({c, model.geometry(slot), places.arms});
  row.start(places.position.data(), 1);
  c.nearest = row.nearest;
}

namespace {

std::shared_ptr<const shape::Surface> make_surface(const Model& model, const SurfaceData& data) {
  if (data.function == 0) return shape::make_surface(shape::from_data(data.shape));
  const auto found = model.surface_functions.find(data.function);
  if (found == model.surface_functions.end()) return std::make_shared<shape::FunctionSurface>(nullptr, 1.0);
  return std::make_shared<shape::FunctionSurface>(found->second.phi, found->second.size);
}

}  // namespace

void SurfaceForm::make_geometry(const Model& model, const Constraint& c, ConstraintGeometry& made) {
  made.surfaces[1] = make_surface(model, c.surfaces[1]);
}

void SurfacePairForm::make_geometry(const Model& model, const Constraint& c, ConstraintGeometry& made) {
  for (const int side : {1, 0}) made.surfaces[side] = make_surface(model, c.surfaces[side]);
}

std::uint32_t make_constraint(Model& model, const SurfaceConstraintData& spec) {
  const Side b = spec.body ? Side(model, spec.body.slot) : Side();
  require_frame(info(spec.kind).name, b);
  Constraint c;
  c.kind = spec.kind;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  c.particles[a_origin] = spec.particle.slot;
  c.surfaces[1] = spec.surface.data;
  const auto surface = make_surface(model, c.surfaces[1]);
  // No step is short enough round a sharp edge: a point on it would gain or lose speed there.
  if (info(spec.kind).sign == 0 && surface->skin() > 0)
    cannot(info(spec.kind).name,
           "the shape has sharp edges, and a point that is held on them has no direction there; "
           "give a box or cylinder a rounding, or keep the point inside or outside");
  make_frame(model, c, b, b_origin, spec.surface.position, spec.surface.orientation);
  return Joints::add(model, c);
}

std::uint32_t make_constraint(Model& model, const SurfacePairData& spec) {
  const std::array<Side, 2> sides{Side(model, spec.a.slot), spec.b ? Side(model, spec.b.slot) : Side()};
  Constraint c;
  c.kind = spec.kind;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  for (std::size_t i = 0; i < 2; ++i) {
    require_frame(info(spec.kind).name, sides[i]);
    c.surfaces[i] = spec.surfaces[i].data;
    (void)make_surface(model, c.surfaces[i]);
  }
  for (std::size_t i = 0; i < 2; ++i)
    make_frame(model, c, sides[i], i == 0 ? a_origin : b_origin, spec.surfaces[i].position,
               spec.surfaces[i].orientation);
  return Joints::add(model, c);
}

}  // namespace iota::ingredient
