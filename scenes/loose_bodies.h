// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include "scenes/dice.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace iota::scenes {

/// Boxes on a grid of side^3 places, without gravity, that spin and drift slowly. Ropes tie random pairs of neighbors.
/// In each step some ropes end, and as many tie other pairs.
struct LooseBodies {
  static constexpr double size = 0.5, distance = 1;  ///< of a box, and of neighbors, m

  System& system;
  Dice dice{7};
  std::vector<BodyId> bodies;
  std::vector<ParticleId> knots;                               ///< one on a corner of each box
  std::vector<std::pair<std::size_t, std::size_t>> neighbors;  ///< indices of bodies; those without a rope first
  std::vector<ConstraintId> ropes;                             ///< of the last ones of `neighbors`, in reverse order

  LooseBodies(System& system, int side, std::size_t ties) : system(system) {
    const auto index = [&](int x, int y, int z) { return static_cast<std::size_t>((z * side + y) * side + x); };
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const Vec3 place{x * distance, y * distance, z * distance};
          bodies.push_back(
              system.bodies().create(Box{{size, size, size}}, {.position = place,
                                                               .velocity = dice.point(0.05),
                                                               .spin = dice.point(0.5),
                                                               .attachments = {{size / 2, size / 2, size / 2}}}));
          knots.push_back(system.bodies().attachments(bodies.back())[0]);
          if (x > 0) neighbors.push_back({index(x - 1, y, z), index(x, y, z)});
          if (y > 0) neighbors.push_back({index(x, y - 1, z), index(x, y, z)});
          if (z > 0) neighbors.push_back({index(x, y, z - 1), index(x, y, z)});
        }
    for (std::size_t i = 0; i < ties; ++i) tie();
  }
  void tie() {
    const std::size_t last = neighbors.size() - ropes.size() - 1;
    std::swap(neighbors[dice.below(static_cast<std::uint32_t>(last + 1))], neighbors[last]);
    const auto [a, b] = neighbors[last];
    const Vec3 apart = system.particles().position(knots[a]) - system.particles().position(knots[b]);
    ropes.push_back(system.joints().create(
        DistanceSpec{.kind = ConstraintKind::rope, .p = knots[a], .q = knots[b], .length = 1.01 * norm(apart)}));
  }
  void part() {
    const std::size_t which = dice.below(static_cast<std::uint32_t>(ropes.size()));
    system.joints().destroy(ropes[which]);
    const auto pair_of = [&](std::size_t rope) -> auto& { return neighbors[neighbors.size() - 1 - rope]; };
    std::swap(pair_of(which), pair_of(ropes.size() - 1));
    ropes[which] = ropes.back(), ropes.pop_back();
  }
  /// Ends some ropes and ties as many pairs anew.
  void change(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) part();
    for (std::size_t i = 0; i < count; ++i) tie();
  }
};

}  // namespace iota::scenes
