// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cstdint>
#include <optional>

namespace iota::contact {

/// How the gap of a touch depends on the motion of its two bodies.
enum class TouchForm : std::uint8_t {
  face,   ///< normal . (center - origin) - radius; the normal turns with the body of the plane
  edges,  ///< the same, with a normal that keeps its direction
  round,  ///< |d - (axis . d) axis| - radius, d = center - origin; the axis keeps its direction
  wires   ///< sqrt(d.d - bends_0 (axis . d)^2 - bends_1 (side . d)^2) - radius, side = normal x axis: wires that cross
};

/// A circle that lies on a plane, with a wire of the touch's radius.
struct Rim {
  Vec3 middle, first, second;  ///< two arms at right angles, as long as its radius
  std::uint32_t name = 0;      ///< of those of a part
};

/// A place of one outline near the surface of another one, with the plane that touches that surface there. What is
/// round turns without changing its distance: it touches with a ball of `radius` around `center`.
struct Touch {
  std::uint32_t part = 0;     ///< of the first outline: the solid's number, or a line's first or second point
  std::uint32_t feature = 0;  ///< of the part: a corner, an end, a point of a rim
  std::uint32_t other_part = 0, other_feature = 0;  ///< of the second outline: a face, an edge
  bool is_turned = false;  ///< the plane is the first outline's, and the point that touches it the second's
  TouchForm form = TouchForm::face;
  Vec3 center;  ///< normal . (center - origin) - radius is the gap, in each form
  Vec3 place;   ///< of the surface with the point, nearest to the plane
  Vec3 origin,
      normal;  ///< of the plane: a point, and the unit vector away from its body; round: the center of what is round
  Vec3 axis;   ///< round: a unit vector, or zero; wires: along the first one
  double bends[2] = {1, 1};  ///< wires: 1 where they are straight, more where they bend around each other
  double radius = 0;         ///< m; round: of both together
  double gap = 0;            ///< m, negative: overlap
  std::optional<Rim> rim;    ///< that the point is on, if all of it lies over the plane
};

}  // namespace iota::contact
