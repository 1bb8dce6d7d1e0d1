// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "laws/particle_arrays.h"

#include <algorithm>
#include <cstddef>
#include <random>

namespace iota::neighbors {

/// Particles of 1.5 kg at random places and velocities within a cube of half the side `size`.
inline laws::ParticleArrays cloud(std::size_t n, double size, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return std::uniform_real_distribution(-size, size)(random); };
  laws::ParticleArrays p;
  p.resize(n);
  for (auto* const a : {&p.x, &p.y, &p.z, &p.vx, &p.vy, &p.vz})
    for (double& v : *a) v = number();
  std::fill(p.m.begin(), p.m.end(), 1.5);
  return p;
}

inline double distance2(const laws::ParticleArrays& p, std::size_t i, std::size_t j) {
  const double x = p.x[j] - p.x[i], y = p.y[j] - p.y[i], z = p.z[j] - p.z[i];
  return x * x + y * y + z * z;
}

}  // namespace iota::neighbors
