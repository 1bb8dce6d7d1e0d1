// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/attributes.h>
#include <iota/ids.h>
#include <iota/shapes.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <cstdint>
#include <vector>

namespace iota {

/// A source of particles (Reeves 1983): each is a dynamic body of its own, and is destroyed at the end of its lifetime.
struct EmitterOptions {
  double rate = 10;  ///< births a second
  /// Places of birth: uniform within the shape. Not a Mesh or HalfSpace.
  Shape source = Sphere{0.01};
  Vec3 position;                    ///< of the source's origin, m
  Quaternion orientation;           ///< of the source's frame
  Vec3 velocity{0, 1, 0};           ///< in the source's frame, m/s
  double velocity_spread = 0;       ///< a random velocity of at most this is added, m/s
  double lifetime = 1;              ///< s
  double lifetime_spread = 0;       ///< lifetimes differ by at most this, s; below `lifetime`
  double mass = 0.001;              ///< kg
  double damping = 0;               ///< of their bodies, 1/s
  std::uint32_t max_count = 1000;   ///< largest number alive at once
  std::vector<AttributeKey> curve;  ///< at most 8, by rising life; linear in between
  std::uint64_t seed = 1;           ///< equal seeds, equal particles
};

/// Sources of particles with a lifetime.
class Emitters : public View {
 public:
  explicit Emitters(Core& core) : View(core) {}

  EmitterId create(const EmitterOptions& options);
  void destroy(EmitterId);  ///< its particles remain
  bool contains(EmitterId) const;

  bool is_active(EmitterId) const;
  void set_active(EmitterId, bool);
  double rate(EmitterId) const;
  void set_rate(EmitterId, double per_second);
  void move(EmitterId, const Vec3& position, const Quaternion& orientation);
  std::uint32_t count(EmitterId) const;  ///< alive now
  std::uint64_t born(EmitterId) const;   ///< so far
  std::vector<ParticleId> particles(EmitterId) const;
};

}  // namespace iota
