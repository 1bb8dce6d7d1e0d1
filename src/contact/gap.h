// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"

#include <limits>
#include <optional>

namespace iota::contact {

/// The distance of two outlines, and the points of their surfaces that are nearest to each other.
struct Gap {
  double distance = std::numeric_limits<double>::infinity();  ///< m; 0 where they overlap
  Vec3 on_first, on_second;                                   ///< where they overlap: one place in both
};

/// Shapes that are not convex count by their triangles, a torus within a hundredth of its wire.
Gap gap(const Outline& first, const Outline& second);

/// The first touch of something that goes straight.
struct Cast {
  double distance = 0;  ///< that it has gone, m; 0 if it overlaps at the start
  Vec3 point;           ///< of the outline
};
/// A convex bounded shape goes along a unit vector, by conservative advancement: it may go as far as the plane between it and each
/// convex piece of the outline lets it (Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, 1996). Exact to 1e-9 of
/// its size, of cylinders, cones and ellipsoids to 1e-6.
std::optional<Cast> cast(const Outline&, const Solid& probe, const Vec3& unit, double farthest);

}  // namespace iota::contact
