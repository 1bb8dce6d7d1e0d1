// SPDX-License-Identifier: Apache-2.0
#include "contact/segments.h"

#include <algorithm>

namespace iota::contact {

// The nearest point of a line is that of the segment if it is on it; otherwise an end is nearest, and the point of the other
// segment is that nearest to this end.
NearestOfSegments nearest_of_segments(const Vec3& a, const Vec3& a_end, const Vec3& b, const Vec3& b_end) {
  const Vec3 u = a_end - a, v = b_end - b, w = a - b;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const Vec3 normal = cross(u, v);
  const double squared = dot(normal, normal);  // uu vv - uv^2, without cancellation
  const auto share = [](double part, double whole) { return whole > 0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0; };
  double s = squared > 1e-24 * uu * vv ? std::clamp((uv * vw - vv * uw) / squared, 0.0, 1.0) : 0.0;
  double t = share(vw + s * uv, vv);
  s = share(t * uv - uw, uu);
  t = share(vw + s * uv, vv);
  return {a + s * u, b + t * v, s, t};
}

}  // namespace iota::contact
