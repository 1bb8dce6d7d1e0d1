// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/vec3.h>

#include <cstdint>

namespace iota {

/// The bodies that a body touches: those that stand and those that move, those that stand, or none. Both must agree.
/// As wide as a double, so that a Material has no padding.
enum class Touches : std::uint64_t { all, obstacles, nothing };

/// How the outline of a body touches others. A body without a material touches nothing.
struct Material {
  /// Coulomb's coefficient. Of two bodies that touch the geometric mean counts.
  double friction = 0.5;
  Touches touches = Touches::all;

  friend bool operator==(const Material&, const Material&) = default;
};

/// A place where a body touches another one.
struct ContactPoint {
  BodyId other;
  Vec3 position;  ///< world, m
  Vec3 normal;    ///< unit vector towards the body
  Vec3 force;     ///< on the body in the last step, N
};

/// The hardest touch of a step. speed: of the approach, m/s; 0: nothing began to touch.
struct Impact {
  Vec3 position;  ///< world, m
  double speed = 0;

  friend bool operator==(const Impact&, const Impact&) = default;
};

}  // namespace iota
