// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cstdint>

namespace iota::laws {

/// Gradient noise (Perlin, SIGGRAPH 1985 and 2002) on a unit lattice: smooth to the second derivative, zero at lattice points,
/// within [-1, 1], the same bits everywhere. With its gradient.
struct Noise {
  double value = 0;
  Vec3 gradient;
};
Noise gradient_noise(const Vec3& x, std::uint32_t seed);

struct Turbulence {
  Vec3 mean;             ///< m/s
  double speed = 1;      ///< of the largest eddies, m/s
  double size = 1;       ///< of the largest eddies, m
  int octaves = 3;       ///< each has half the size and, by Kolmogorov's 5/3 law, 2^(-1/3) times the speed
  double evolution = 0;  ///< rate of change of the pattern, 1/s
  std::uint32_t seed = 0;
};

/// Velocity of a turbulent current: fractional Brownian motion as the curl of a noise potential, so without divergence
/// (Bridson, Hourihan, Nordenstam, SIGGRAPH 2007).
Vec3 turbulent_velocity(const Turbulence&, const Vec3& position, double time);

}  // namespace iota::laws
