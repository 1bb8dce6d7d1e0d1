// SPDX-License-Identifier: Apache-2.0
//
// What is no chain of rods: nets full of loops, chains of general rigid bodies, a heavy end.
#include "bench/engine/measure.h"
#include "scenes/chain.h"
#include "scenes/net.h"

#include <cmath>
#include <string>

namespace iota::bench {
namespace {

const char* name_of(IntegrationMode mode) { return mode == IntegrationMode::robust ? "robust" : "energy_keeping"; }

/// A chain of bodies of four particles, none of them on the line of its two hinges: the general case.
void make_rigid_chain(System& system, int links) {
  ParticleId last;
  for (int i = 0; i < links; ++i) {
    const BodyId body = system.bodies().create();
    const double x = 0.1 * i;
    const ParticleId first = system.particles().create(body, {x, 0, 0}, 0.025);
    const ParticleId end = system.particles().create(body, {x + 0.1, 0, 0}, 0.025);
    (void)system.particles().create(body, {x + 0.05, 0.03, 0}, 0.025);
    (void)system.particles().create(body, {x + 0.05, 0, 0.03}, 0.025);
    if (i > 0)
      (void)system.edits().combine(last, first);
    else
      system.particles().nail(first);
    last = end;
  }
}

/// A body of `hinges` points with a link hinged to each.
void make_hub(System& system, int hinges) {
  const BodyId hub = system.bodies().create();
  for (int i = 0; i < hinges; ++i) {
    const double angle = 6.283185307179586 * i / hinges, radius = 1 + 0.2 * (i % 3);
    const Vec3 at{radius * std::cos(angle), 0.1 * (i % 5), radius * std::sin(angle)};
    const ParticleId on_hub = system.particles().create(hub, at, 0.01);
    const BodyId link = system.bodies().create();
    const ParticleId top = system.particles().create(link, at, 0.05);
    (void)system.particles().create(link, at + Vec3{0, -0.3, 0.05}, 0.05);
    (void)system.edits().combine(on_hub, top);
    if (i == 0) system.particles().nail(on_hub);
  }
}

const bool registered = [] {
  for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    const auto add = [&](const std::string& what, int size, int steps, auto run) {
      benchmark::RegisterBenchmark((what + '/' + name_of(mode) + "/120").c_str(),
                                   [=](benchmark::State& state) { run(state, static_cast<int>(state.range(0))); })
          ->Arg(size)
          ->Iterations(steps)
          ->MeasureProcessCPUTime()
          ->Unit(benchmark::kMicrosecond);
    };
    for (const int links : {64, 512, 4096})
      add("rigid_chain", links, links <= 512 ? 1200 : 240, [mode](benchmark::State& state, int n) {
        System system({.mode = mode, .threads = 1});
        make_rigid_chain(system, n);
        step_and_judge(state, system, n, 120);
      });
    for (const int hinges : {100, 1000})
      add("hub", hinges, 120, [mode](benchmark::State& state, int n) {
        System system({.mode = mode, .threads = 1});
        make_hub(system, n);
        step_and_judge(state, system, n, 120);
      });
    for (const int side : {16, 32, 64, 100}) {
      if (side > 32 && mode == IntegrationMode::energy_keeping) continue;  // minutes
      add("net", side, side <= 32 ? 240 : 20, [mode](benchmark::State& state, int n) {
        System system({.mode = mode, .threads = 1});
        const int links = static_cast<int>(scenes::make_net(system, {.side = n}).links.size());
        step_and_judge(state, system, links, 120);
      });
    }
    add("heavy_end", 64, 1200, [mode](benchmark::State& state, int n) {
      System system({.mode = mode, .threads = 1});
      (void)scenes::make_chain(system, {.links = n, .rods = true, .heavy_end = 1000});
      step_and_judge(state, system, n, 120);
    });
  }
  return true;
}();

}  // namespace
}  // namespace iota::bench
