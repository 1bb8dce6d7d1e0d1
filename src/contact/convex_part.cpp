// SPDX-License-Identifier: Apache-2.0
#include "contact/convex_part.h"

#include "contact/outline.h"

#include "math/mat3.h"

#include <cmath>
#include <variant>

namespace iota::contact {

namespace {

/// Less of a core's radius, in its length: it is a rod.
constexpr double thinnest_core = 1e-9;

/// The polytope within a cylinder or a cone.
void place_round(const Polytope& polytope, ConvexPart& part) {
  part.core = &polytope;
  const Vec3 x = part.half.x * part.axes[0], y = part.half.y * part.axes[1], z = part.half.z * part.axes[2];
  for (const Vec3& corner : polytope.corners)
    part.corners.push_back(part.middle + corner.x * x + corner.y * y + corner.z * z);
  for (const Polytope::Face& face : polytope.faces) {
    const Vec3& n = face.normal;
    part.normals.push_back(n.x * part.axes[0] + n.y * part.axes[1] + n.z * part.axes[2]);
  }
}

}  // namespace

void set_segment(const Vec3& a, const Vec3& b, ConvexPart& part) {
  const bool is_point = a == b;
  part.kind = ConvexPart::Kind::polytope;
  part.core = is_point ? &point_polytope() : &segment_polytope();
  part.corners.clear(), part.normals.clear();
  part.corners.push_back(a);
  if (!is_point) part.corners.push_back(b);
  part.middle = 0.5 * (a + b);
  part.size = norm(b - a) + 2 * part.radius;
  part.is_box = false;
}

Vec3 farthest(const ConvexPart& part, const Vec3& direction) {
  if (part.is_polytope()) return part.corners[part.support(direction)];
  const Vec3& half = part.half;
  const Vec3 d{dot(direction, part.axes[0]), dot(direction, part.axes[1]), dot(direction, part.axes[2])};
  Vec3 local;
  if (part.kind == ConvexPart::Kind::ellipsoid) {
    const Vec3 scaled{half.x * d.x, half.y * d.y, half.z * d.z};
    const double length = norm(scaled);
    if (!(length > 0)) return part.middle;
    local = (1 / length) * Vec3{half.x * scaled.x, half.y * scaled.y, half.z * scaled.z};
  } else {
    const double across = std::sqrt(d.y * d.y + d.z * d.z);
    const Vec3 rim = across > 0 ? Vec3{0, half.y * d.y / across, half.y * d.z / across} : Vec3{0, half.y, 0};
    if (part.kind == ConvexPart::Kind::cylinder)
      local = rim + Vec3{d.x < 0 ? -half.x : half.x, 0, 0};
    else
      local = 2 * half.x * d.x > half.y * across ? Vec3{half.x, 0, 0} : rim - Vec3{half.x, 0, 0};
  }
  return part.middle + local.x * part.axes[0] + local.y * part.axes[1] + local.z * part.axes[2];
}

void place_part(const Solid& solid, const Polytope* hull, const Vec3& anchor, ConvexPart& part) {
  part.is_line = part.is_box = false;
  part.kind = ConvexPart::Kind::polytope;
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
  part.axes = {rotate(solid.turn, {1, 0, 0}), rotate(solid.turn, {0, 1, 0}), rotate(solid.turn, {0, 0, 1})};
  if (const auto* const c = std::get_if<Cylinder>(&shape)) {
    part.radius = c->rounding;
    const double across = c->radius - c->rounding, along = 0.5 * c->length - c->rounding;
    if (!(across > thinnest_core * part.size))
      return set_segment(position - along * part.axes[0], position + along * part.axes[0], part);
    part.kind = ConvexPart::Kind::cylinder;
    part.half = {along, across, across};
    return place_round(prism_polytope(), part);
  }
  if (const auto* const c = std::get_if<Cone>(&shape)) {
    part.kind = ConvexPart::Kind::cone;
    part.half = {0.5 * c->length, c->radius, c->radius};
    return place_round(pyramid_polytope(), part);
  }
  if (const auto* const e = std::get_if<Ellipsoid>(&shape)) {
    part.kind = ConvexPart::Kind::ellipsoid;
    part.core = &point_polytope();
    part.half = 0.5 * e->size;
    part.corners.push_back(position);
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
