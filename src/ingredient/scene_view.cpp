// SPDX-License-Identifier: Apache-2.0
#include "ingredient/scene_view.h"

#include "ingredient/model.h"
#include "math/mat3.h"

#include <iota/scene.h>

namespace iota::ingredient {

SceneView::SceneView(const model::Model& model, bool whole) : model(model), structure_(model), whole_(whole) {}

Vec3 SceneView::into_body(std::uint32_t body, const Vec3& direction) const {
  const Quaternion& q = structure_.bodies[body].orientation;
  return rotate({-q.x, -q.y, -q.z, q.w}, direction);
}

Vec3 SceneView::point_in(std::uint32_t body, const Vec3& place) const {
  return into_body(body, place - structure_.center_of_mass(body));
}

Anchor SceneView::anchor(std::uint32_t body, const Vec3& place) const {
  if (body == model::none) return {{}, place};
  return {structure_.bodies.id(body), point_in(body, place)};
}

Anchor SceneView::anchor(std::uint32_t particle) const {
  return anchor(structure_.particles[particle].body, structure_.position(particle));
}

}  // namespace iota::ingredient
