// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <vector>

namespace iota::scenes {

struct NetOptions {
  int side = 32;             ///< knots along each edge
  double link_length = 0.1;  ///< m
  double link_mass = 0.1;    ///< kg
  double radius = 0.005;     ///< m, of rods
  bool rods = true;          ///< cylinder inertia; otherwise half the mass at each end
  Vec3 corner{0, 0, 0};      ///< the net lies in the x-z plane from here on
};

struct Net {
  std::vector<BodyId> links;
  std::vector<ParticleId> knots;  ///< one particle of each knot's ring, row by row
};

/// A square net of hinged links, all loops closed, held at two neighboring corners: side * side knots and
/// 2 side (side - 1) links.
inline Net make_net(System& system, const NetOptions& o) {
  Net net;
  const auto side = static_cast<std::size_t>(o.side);
  net.knots.resize(side * side);
  const auto place = [&](std::size_t row, std::size_t column) {
    return o.corner + o.link_length * Vec3{static_cast<double>(column), 0, static_cast<double>(row)};
  };
  const auto link = [&](std::size_t row, std::size_t column, std::size_t to_row, std::size_t to_column) {
    const BodyId body = system.bodies().create();
    net.links.push_back(body);
    const ParticleId ends[2] = {system.particles().create(body, place(row, column), o.link_mass / 2),
                                system.particles().create(body, place(to_row, to_column), o.link_mass / 2)};
    if (o.rods) system.bodies().set_rod(body, o.link_mass, o.radius);
    const std::size_t at[2] = {row * side + column, to_row * side + to_column};
    for (int end = 0; end < 2; ++end) {
      ParticleId& knot = net.knots[at[end]];
      if (knot)
        (void)system.edits().combine(knot, ends[end]);
      else
        knot = ends[end];
    }
  };
  for (std::size_t row = 0; row < side; ++row)
    for (std::size_t column = 0; column < side; ++column) {
      if (column + 1 < side) link(row, column, row, column + 1);
      if (row + 1 < side) link(row, column, row + 1, column);
    }
  system.particles().nail(net.knots.front());
  system.particles().nail(net.knots[side - 1]);
  return net;
}

}  // namespace iota::scenes
