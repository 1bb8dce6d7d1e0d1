// SPDX-License-Identifier: Apache-2.0
#include "contact/convex_part.h"

#include "math/mat3.h"

#include <variant>

namespace iota::contact {

namespace {

void set_segment(const Vec3& a, const Vec3& b, ConvexPart& part) {
  const bool is_point = a == b;
  part.core = is_point ? &point_polytope() : &segment_polytope();
  part.corners.clear(), part.normals.clear();
  part.corners.push_back(a);
  if (!is_point) part.corners.push_back(b);
  part.middle = 0.5 * (a + b);
  part.size = norm(b - a) + 2 * part.radius;
  part.is_box = false;
}

}  // namespace

bool has_simple_core(const Solid& solid) {
  const Shape& shape = solid.form->shape;
  return std::holds_alternative<Sphere>(shape) || std::holds_alternative<Box>(shape) ||
         std::holds_alternative<Capsule>(shape);
}

void place_part(const Solid& solid, const Polytope* hull, const Vec3& anchor, ConvexPart& part) {
  part.is_line = part.is_box = false;
  part.number = solid.number;
  const Vec3 position = solid.position - anchor;
  const Shape& shape = solid.form->shape;
  if (const auto* const s = std::get_if<Sphere>(&shape)) {
    part.radius = s->radius;
    return set_segment(position, position, part);
  }
  if (const auto* const c = std::get_if<Capsule>(&shape)) {
    part.radius = c->radius;
    const Vec3 half = rotate(solid.turn, {0.5 * c->length, 0, 0});
    return set_segment(position - half, position + half, part);
  }
  part.radius = 0;
  part.corners.clear(), part.normals.clear();
  part.middle = position;
  part.size = norm(solid.form->box.high - solid.form->box.low);
  if (const auto* const b = std::get_if<Box>(&shape)) {
    part.core = &cube_polytope();
    part.is_box = true;
    part.radius = b->rounding;
    part.half = 0.5 * b->size - Vec3{b->rounding, b->rounding, b->rounding};
    part.axes = {rotate(solid.turn, {1, 0, 0}), rotate(solid.turn, {0, 1, 0}), rotate(solid.turn, {0, 0, 1})};
    const Vec3 x = part.half.x * part.axes[0], y = part.half.y * part.axes[1], z = part.half.z * part.axes[2];
    for (std::uint32_t k = 0; k < 8; ++k)
      part.corners.push_back(position + (k & 1 ? x : -x) + (k & 2 ? y : -y) + (k & 4 ? z : -z));
    for (const Vec3& axis : part.axes) part.normals.push_back(-axis), part.normals.push_back(axis);
    return;
  }
  part.core = hull;
  part.middle = position + rotate(solid.turn, 0.5 * (solid.form->box.low + solid.form->box.high));
  for (const Vec3& corner : hull->corners) part.corners.push_back(position + rotate(solid.turn, corner));
  for (const Polytope::Face& face : hull->faces) part.normals.push_back(rotate(solid.turn, face.normal));
}

void place_part(const Line& line, const Vec3& anchor, ConvexPart& part) {
  part.is_line = true;
  part.radius = line.radius;
  part.end = {line.p, 0}, part.other_end = {line.q, 0}, part.line = {line.p, 1 + line.q};
  set_segment(line.a - anchor, line.b - anchor, part);
}

}  // namespace iota::contact
