// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/polytope.h"

#include <array>
#include <cstdint>
#include <vector>

namespace iota::contact {

struct Line;
struct Solid;

/// A name of a corner, an edge or a face: see Touch.
struct FeatureName {
  std::uint32_t part = 0, feature = 0;
  friend bool operator==(const FeatureName&, const FeatureName&) = default;
};

/// A convex part of an outline at its place: all points within `radius` of its core. A ball has a point as its core, a
/// capsule and a rod a segment, a rounded box a smaller box. Places are relative to an anchor, so that they are precise far
/// from the origin of the world.
struct ConvexPart {
  enum class Kind : std::uint8_t { polytope, cylinder, cone, ellipsoid };
  Kind kind = Kind::polytope;
  const Polytope* core = nullptr;      ///< of a cylinder and a cone: one within it, with the same ends
  std::vector<Vec3> corners, normals;  ///< of the core's faces
  Vec3 middle;
  std::array<Vec3, 3> axes;  ///< of a box and an ellipsoid; the first is that of a cylinder and a cone
  Vec3 half;                 ///< half the sizes of the core along the axes
  Vec3 spin;                 ///< of the body in half a step, rad
  bool is_box = false;
  double radius = 0;
  double size = 0;                   ///< of the whole part
  FeatureName end, other_end, line;  ///< of a line
  std::uint32_t number = 0;          ///< of a solid
  bool is_line = false;

  bool is_point() const { return core->edges.empty(); }
  bool is_polytope() const { return kind == Kind::polytope; }
  std::uint32_t support(const Vec3& direction) const {  ///< the number of the farthest corner
    std::uint32_t best = 0;
    double most = dot(corners[0], direction);
    for (std::uint32_t k = 1; k < corners.size(); ++k)
      if (const double far = dot(corners[k], direction); far > most) most = far, best = k;
    return best;
  }
  FeatureName corner_name(std::uint32_t corner) const {
    return is_line ? (corner == 0 ? end : other_end) : FeatureName{number, corner};
  }
  FeatureName edge_name(std::uint32_t edge) const { return is_line ? line : FeatureName{number, 1u << 28 | edge}; }
  FeatureName face_name(std::uint32_t face) const { return {number, 2u << 28 | face}; }
  FeatureName side_name(std::uint32_t side) const { return {number, 3u << 28 | side}; }     ///< of a face
  FeatureName beneath_name(std::uint32_t face) const { return {number, 4u << 28 | face}; }  ///< of a place of a face
};

/// A farthest point of the core; the direction need not have unit length.
Vec3 farthest(const ConvexPart&, const Vec3& direction);
/// Makes it a ball or a rod.
void set_segment(const Vec3& a, const Vec3& b, ConvexPart&);
/// hull: of a mesh.
void place_part(const Solid&, const Polytope* hull, const Vec3& anchor, ConvexPart&);
void place_part(const Line&, const Vec3& anchor, ConvexPart&);

}  // namespace iota::contact
