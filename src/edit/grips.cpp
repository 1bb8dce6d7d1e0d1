// SPDX-License-Identifier: Apache-2.0
#include "edit/grips.h"

#include "ingredient/grips.h"
#include "math/checks.h"
#include "math/mat3.h"

#include <span>

namespace iota::edit {

namespace {

/// From the center of a body, in world axes. How a rod has turned about its axis depends on when its frame was looked at, which a
/// replay does not repeat: its places are those of the axis.
Vec3 arm_of(const model::Model& model, std::uint32_t slot, const Vec3& local_point) {
  const model::Body& body = model.bodies[slot];
  if (body.rank != 2 || body.first_solid != model::none) return rotate(body.orientation, local_point);
  const Vec3 along = model.position(body.basis[1]) - model.position(body.basis[0]);
  return local_point.x * unit_or(along, Vec3{}, 0);
}

}  // namespace

GripId apply(Editor& e, const CreateGrip& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_finite("local_point", c.local_point);
  require_finite("target", c.target);
  require_positive("frequency", c.options.frequency);
  require_positive("max_acceleration", c.options.max_acceleration);
  if (model.bodies[body].count == 0) throw std::invalid_argument(text("body ", body, " has no particles to hold"));
  e.orientations.refresh(model, std::span(&body, 1));
  ingredient::Grip grip;
  grip.body = body;
  grip.client = c.options.client, grip.hold = c.options.hold;
  grip.frequency = c.options.frequency, grip.max_acceleration = c.options.max_acceleration;
  grip.target = c.target;
  ingredient::Grips::anchor(model, grip, model.center_of_mass(body) + arm_of(model, body, c.local_point));
  ingredient::Grips::mark(model, body);
  return model.grips.create(grip);
}

void apply(Editor& e, const MoveGrip& c) {
  require_finite("target", c.target);
  e.model.grips[e.require(c.grip)].target = c.target;
}

void apply(Editor& e, const Destroy<GripId>& c) {
  model::Model& model = e.model;
  const std::uint32_t grip = e.require(c.id);
  ingredient::Grips::mark(model, model.grips[grip].body);
  model.grips.destroy(grip);
}

}  // namespace iota::edit
