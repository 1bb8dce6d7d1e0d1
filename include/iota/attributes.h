// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>

namespace iota {

/// Red, green, blue, opacity; 0 to 1.
using Color = std::array<float, 4>;

/// Optional attributes of a particle, besides place, velocity and mass.
struct ParticleAttributes {
  double age = 0;                                             ///< s
  double lifetime = std::numeric_limits<double>::infinity();  ///< s
  double radius = 0;                                          ///< m; 0: not given
  Color color{1, 1, 1, 1};
};

/// Look of an emitted particle at one point of its life.
struct AttributeKey {
  double life = 0;    ///< 0 birth, 1 death
  double radius = 0;  ///< m
  Color color{1, 1, 1, 1};
};

}  // namespace iota
