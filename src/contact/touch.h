// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cstdint>

namespace iota::contact {

/// A place of one outline near the surface of another one, with the plane that touches that surface there. What is
/// round turns without changing its distance: it touches with a ball of `radius` around `center`.
struct Touch {
  std::uint32_t part = 0;     ///< the solid's number, or a line's first or second point
  std::uint32_t feature = 0;  ///< of the part: a corner, an end, a point of a rim
  Vec3 center;                ///< normal . (center - origin) - radius is the gap
  Vec3 place;                 ///< of the surface of the body, nearest to the plane
  Vec3 origin, normal;        ///< of the plane: a point, and the unit vector towards the body
  double radius = 0;          ///< m
  double gap = 0;             ///< m, negative: overlap
};

}  // namespace iota::contact
