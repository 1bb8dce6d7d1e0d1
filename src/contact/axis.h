// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/convex_part.h"

#include <cstdint>
#include <limits>
#include <optional>

namespace iota::contact {

/// A direction along which the cores of two parts are apart: a normal of a plane between them.
struct Axis {
  enum class Kind : std::uint8_t { face_of_second, face_of_first, edges };
  Kind kind = Kind::face_of_second;
  std::uint32_t first = 0, second = 0;  ///< the face, or an edge of each
  Vec3 normal;                          ///< unit vector from the second part to the first
  double apart = 0;                     ///< m, negative: overlap
  double most_apart = 0;                ///< of all axes; never more than the distance of the cores
  bool is_farthest = true;              ///< most_apart is not along another direction
  struct Edges {
    std::uint32_t first = 0, second = 0;
    Vec3 normal;
    double apart = -std::numeric_limits<double>::infinity();
  };
  Edges edges;  ///< the best two
};

/// Separating axis test: the axis along which the cores are farthest apart, by the faces of both and by pairs of edges.
/// One of them has faces. Nothing if they are farther apart than `limit` along any axis. Faces of the second are preferred
/// to those of the first, and these to edges, where they are nearly as good. way: of the first relative to the second in the
/// coming step, m: of several planes that are between the parts now, that along which they stay apart is taken, so that what slides
/// over a seam is not stopped by the side of the next one.
std::optional<Axis> find_axis(const ConvexPart& first, const ConvexPart& second, const Vec3& way, double limit);

}  // namespace iota::contact
