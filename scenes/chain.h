// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <vector>

/// Scenes that tests, benchmarks and examples share.
namespace iota::scenes {

struct ChainOptions {
  int links = 24;
  double link_length = 0.1;  ///< m
  double link_mass = 0.1;    ///< kg
  double radius = 0.005;     ///< m, of rods
  bool rods = false;         ///< cylinder inertia; otherwise half the mass at each end
  bool nailed = true;        ///< at the upper end
  double heavy_end = 1;      ///< the last link's mass, in links
  Vec3 top{0, 0, 0};
  Vec3 direction{1, 0, 0};  ///< unit; horizontal: released from the side
};

struct Chain {
  std::vector<BodyId> links;
  std::vector<ParticleId> upper, lower;  ///< of each link; lower[i] is hinged with upper[i + 1]
};

inline Chain make_chain(System& system, const ChainOptions& o) {
  Chain chain;
  for (int i = 0; i < o.links; ++i) {
    const double mass = o.link_mass * (i + 1 == o.links ? o.heavy_end : 1);
    const BodyId link = system.bodies().create();
    chain.links.push_back(link);
    chain.upper.push_back(system.particles().create(link, o.top + (i * o.link_length) * o.direction, mass / 2));
    chain.lower.push_back(system.particles().create(link, o.top + ((i + 1) * o.link_length) * o.direction, mass / 2));
    if (o.rods) system.bodies().set_rod(link, mass, o.radius);
    if (i > 0) (void)system.edits().combine(chain.lower[i - 1], chain.upper[i]);
  }
  if (o.nailed) system.particles().nail(chain.upper.front());
  return chain;
}

}  // namespace iota::scenes
