// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/shapes.h>
#include <iota/vec3.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace iota {

/// Red, green, blue, opacity; 0 to 1.
using Color = std::array<float, 4>;

/// How an emitted particle looks at one point of its life.
struct AttributeKey {
  double life = 0;    ///< 0 birth, 1 death
  double radius = 0;  ///< m
  Color color{1, 1, 1, 1};
};

/// A source of particles (Reeves 1983): each is a dynamic body of its own, with an age and a lifetime, and dies at its end.
struct EmitterOptions {
  double rate = 10;  ///< births a second
  /// Where they are born: anywhere within, evenly. No Torus or Mesh.
  Shape source = Sphere{0.01};
  Vec3 position;                    ///< of the source's origin, m
  Quaternion orientation;           ///< of the source's frame
  Vec3 velocity{0, 1, 0};           ///< in the source's frame, m/s
  double velocity_spread = 0;       ///< each gets up to this much in any direction, m/s
  double lifetime = 1;              ///< s
  double lifetime_spread = 0;       ///< each lives up to this much longer or shorter, s; below `lifetime`
  double mass = 0.001;              ///< kg
  double damping = 0;               ///< of their bodies, 1/s
  std::uint32_t max_count = 1000;   ///< alive at once; none is born while there are that many
  std::vector<AttributeKey> curve;  ///< at most 8, by rising life; linear in between
  std::uint64_t seed = 1;           ///< equal seeds, equal particles
};

/// Optional attributes of a particle.
struct ParticleAttributes {
  double age = 0;                                             ///< s
  double lifetime = std::numeric_limits<double>::infinity();  ///< s
  double radius = 0;                                          ///< m; 0: not given
  Color color{1, 1, 1, 1};
};

}  // namespace iota
