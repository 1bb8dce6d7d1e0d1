// SPDX-License-Identifier: Apache-2.0
//
// A chain is hung up by its first link, let go from the horizontal, cut in the middle and put together again.

#include <iota/system.h>

#include <cstdio>
#include <vector>

struct Link {
  iota::ParticleId upper, lower;
};

int main() {
  constexpr int links = 24;
  constexpr double link_length = 0.1, link_mass = 0.05, radius = 0.012;  // m, kg, m
  constexpr double dt = 1.0 / 120;                                       // s

  iota::System system;
  std::vector<Link> chain;
  for (int i = 0; i < links; ++i) {
    const iota::BodyId body = system.bodies().create();
    const iota::ParticleId upper = system.particles().create(body, {i * link_length, 0, 0});
    const iota::ParticleId lower = system.particles().create(body, {(i + 1) * link_length, 0, 0});
    system.bodies().set_rod(body, link_mass, radius);
    if (!chain.empty()) system.edits().combine(chain.back().lower, upper);
    chain.push_back({upper, lower});
  }
  system.particles().nail(chain.front().upper);

  double worst_gap = 0;
  const auto run = [&](double seconds) {
    for (const double end = system.time() + seconds; system.time() < end - dt / 2;) {
      const iota::StepReport report = system.step(dt);
      if (report.worst_gap > worst_gap) worst_gap = report.worst_gap;
    }
  };

  run(3);
  const Link& above = chain[links / 2 - 1];
  const Link& below = chain[links / 2];
  system.edits().separate(above.lower, below.upper);
  std::printf("cut at %.1f s: %u articulates\n", system.time(), system.bodies().articulate_count());
  run(0.5);
  system.edits().combine(above.lower, below.upper);
  std::printf("joined at %.1f s: %u articulates\n", system.time(), system.bodies().articulate_count());
  run(3);

  const iota::Vec3 end = system.particles().position(chain.back().lower);
  std::printf("the free end is at (%.3f, %.3f, %.3f) m after %.1f s\n", end.x, end.y, end.z, system.time());
  std::printf("worst gap: %.3g m\n", worst_gap);
  return worst_gap < 1e-9 ? 0 : 1;
}
