// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/convex_part.h"

#include <optional>

namespace iota::contact {

/// The distance of the cores of two parts along a direction, m; negative: overlap. normal: from the second to the first.
double apart_along(const ConvexPart& first, const ConvexPart& second, const Vec3& normal);

/// The direction of the largest separation of two convex parts, of which one is neither a polytope nor a rod.
struct RoundAxis {
  Vec3 normal;               ///< unit vector from the second part to the first
  double apart = 0;          ///< of the cores along it, m
  Vec3 on_first, on_second;  ///< points of the cores that are nearest to each other
};
/// The best normal of a flat face or of a line between middles and axes.
RoundAxis guess_round_axis(const ConvexPart& first, const ConvexPart& second);
/// The best direction, from a guess. Nothing if they are farther apart than `limit`. Of parts that overlap deeply it is some
/// direction with a small overlap.
std::optional<RoundAxis> find_round_axis(const ConvexPart& first, const ConvexPart& second, const RoundAxis& guessed,
                                         double limit);

}  // namespace iota::contact
