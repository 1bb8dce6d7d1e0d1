// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

namespace iota::contact {

/// The points of two segments that are nearest to each other, and their shares of the ways from the first ends, 0 to 1.
struct NearestOfSegments {
  Vec3 on_first, on_second;
  double of_first = 0, of_second = 0;
};
NearestOfSegments nearest_of_segments(const Vec3& a, const Vec3& a_end, const Vec3& b, const Vec3& b_end);

}  // namespace iota::contact
