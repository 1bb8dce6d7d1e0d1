// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/manifold.h"

#include <array>

namespace iota::contact {

/// The middle line of a torus: a circle, or two half circles with straight lines between them.
struct Ring {
  Vec3 middle;
  std::array<Vec3, 3> axes;  ///< it is in the plane of the first two, and long along the first
  double radius = 0;
  double half_stretch = 0;
  double tube = 0;

  double length() const;
  /// The point at this share of the length, from the end along the first axis.
  Vec3 point(double share) const;
  Vec3 nearest(const Vec3& place) const;
  /// Unit vector along it, at one of its points.
  Vec3 tangent(const Vec3& point) const;
  /// Towards the center of curvature, by its radius, 1/m; zero where it is straight.
  Vec3 bend(const Vec3& point) const;
  /// The quarter around the end of an axis, 0 to 3, so that its number stays while links hang in each other.
  std::uint32_t quarter(const Vec3& point) const;
};
Ring make_ring(const Solid& torus, const Vec3& anchor);

/// The touches of two rings, or of a ring and a ball, a capsule or a rod: at most two where the wires cross, and six where
/// they lie side by side. Wires that cross have the distance of their middle lines to second order, with their bends: with a
/// normal that turned with one of them, links that hang in each other shook until they were apart.
class RingToucher {
 public:
  /// One of the solids is a torus.
  static void add_touches(const Solid* first, const ConvexPart* first_rod, const Solid* second,
                          const ConvexPart* second_rod, const Vec3& anchor, double within, std::vector<Touch>& found);
};

}  // namespace iota::contact
