// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/vec3.h>

#include <compare>
#include <cstdint>
#include <vector>

namespace iota {

/// The bodies that a body touches: those that stand and those that move, those that stand, or none. Both must agree.
/// A sensor has no contacts: watches tell what enters and leaves it, see System::contacts.
/// As wide as a double, so that a Material has no padding.
enum class Touches : std::uint64_t { all, obstacles, nothing, sensor };

/// How the outline of a body touches others. A body without a material touches nothing.
struct Material {
  /// Coulomb's coefficient, while one slides. Of two bodies that touch the geometric mean counts.
  double friction = 0.5;
  Touches touches = Touches::all;
  /// The speed at which two bodies leave each other after an impact, of that at which they met: 0 to 1. Two bodies have the
  /// larger one.
  double restitution = 0;
  /// The coefficient of rolling resistance: the torque against rolling is at most this times the normal force and the radius.
  /// Two bodies have the larger one.
  double rolling = 0;
  /// The velocity of the surface against its body, in the world, m/s: a belt, or an escalator. Friction drives what lies on it.
  Vec3 surface_velocity;

  /// Coulomb's coefficient until one slides, at least `friction`; 0: the same. The geometric mean counts.
  double static_friction = 0;
  /// The coefficient of friction against spinning on the spot: the torque about the normal is at most this times the normal
  /// force and the radius. Two bodies have the larger one.
  double spinning = 0;

  double largest_friction() const { return static_friction > friction ? static_friction : friction; }

  friend bool operator==(const Material&, const Material&) = default;
};

/// A place where a body touches another one.
struct ContactPoint {
  BodyId body, other;
  Vec3 position;        ///< world, m
  Vec3 normal;          ///< unit vector towards the body
  Vec3 force;           ///< on the body in the last step, N
  double gap = 0;       ///< m, negative: overlap
  double slip = 0;      ///< speed of the body along the other one's surface, m/s
  bool slides = false;  ///< friction has its largest value; otherwise the place sticks

  Vec3 friction() const { return force - dot(force, normal) * normal; }
};

/// A body, or the bodies with a particle in a group: one of the two ids is null.
struct ContactParty {
  BodyId body;
  GroupId group;

  friend auto operator<=>(const ContactParty&, const ContactParty&) = default;
};

/// Which touches a watch tells of. Those that begin with less are not told, nor are their ends.
struct ContactFilter {
  std::vector<ContactParty> a, b;  ///< one body is of a, the other one of b; empty: any body
  double min_impulse = 0;          ///< N s
  double min_speed = 0;            ///< m/s
  double cooldown = 0;  ///< after a begin that was told, the next one of the two bodies is not, for so long, s
};

/// Two bodies begin or cease to touch each other.
struct ContactEvent {
  std::uint32_t watch = 0;
  bool began = false;
  BodyId body, other;  ///< of sides a and b of the filter; may be stale at an end
  Vec3 position;       ///< world, m; at an end the last one
  Vec3 normal;         ///< unit vector towards the body
  double impulse = 0;  ///< of the step in which they began to touch, N s
  double speed = 0;    ///< of the approach before it, m/s
};

/// The hardest touch of a step. speed: of the approach, m/s; 0: nothing began to touch.
struct Impact {
  Vec3 position;  ///< world, m
  double speed = 0;

  friend bool operator==(const Impact&, const Impact&) = default;
};

}  // namespace iota
