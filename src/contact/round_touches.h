// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/manifold.h"
#include "contact/round_axis.h"

namespace iota::contact {

/// The touches of two parts of which one is a cylinder, a cone or an ellipsoid. An ellipsoid touches with the ball of its
/// curvature, a cylinder that lies with its middle line, one that leans with the ball that touches its rim from within, one
/// that stands with six points of its rim and the lowest one; a cone likewise.
class RoundToucher {
 public:
  explicit RoundToucher(Clipper& clipper) : clipper_(clipper) {}
  void add_touches(const ConvexPart& first, const ConvexPart& second, const Vec3& anchor, double within,
                   std::vector<Touch>& found);
  /// Only with a face of the second part along a normal, if there is one.
  void add_on_face_of_second(const ConvexPart& first, const ConvexPart& second, const Vec3& normal, const Vec3& anchor,
                             double within, std::vector<Touch>& found);

 private:
  bool add_on_face(const RoundAxis&, bool is_of_first, const Vec3& anchor, double within, std::vector<Touch>& found);
  bool add_simple(const RoundAxis&, const Vec3& anchor, double within, std::vector<Touch>& found);

  Clipper& clipper_;
  const ConvexPart *first_ = nullptr, *second_ = nullptr;
  ConvexPart simple_first_, simple_second_;
};

/// The face of a part whose normal is nearly this direction, or Polytope::none.
std::uint32_t face_along(const ConvexPart&, const Vec3& direction);

/// The touches of two parts whose cores are polytopes, segments or points.
void add_touches_of_polytopes(const ConvexPart& first, const ConvexPart& second, const Vec3& way, TouchWriter&,
                              Clipper&);

}  // namespace iota::contact
