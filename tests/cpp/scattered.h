// SPDX-License-Identifier: Apache-2.0
// Single particles at random, and where they are.
#pragma once

#include <iota/system.h>

#include <random>
#include <vector>

namespace iota {

inline std::vector<ParticleId> scatter(System& system, int count, unsigned seed, double size = 1, double speed = 1) {
  std::mt19937 random(seed);
  const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  std::vector<ParticleId> list;
  for (int i = 0; i < count; ++i)
    list.push_back(system.particles().create(system.bodies().create(), size * Vec3{number(), number(), number()},
                                             0.5 + 0.4 * number(), speed * Vec3{number(), number(), number()}));
  return list;
}

inline std::vector<double> positions(const System& system) {
  std::vector<double> all(3 * system.particles().ids().size());
  system.particles().read_positions(all);
  return all;
}

}  // namespace iota
