// SPDX-License-Identifier: Apache-2.0
//
// The first step of a scene, which builds and analyzes it, and the steps after it.
#include <iota/system.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

namespace iota::bench {
namespace {

double now_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A square cloth of particles with springs, or rods, along its threads, held at two corners.
System make_cloth(int side, bool rods) {
  System system({.mode = IntegrationMode::robust, .threads = 1});
  std::vector<ParticleId> knots;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      knots.push_back(system.particles().create(system.bodies().create(), {1.0 * i / side, 2, 1.0 * j / side}, 1e-3));
  const auto tie = [&](int a, int b) {
    const ParticleId p = knots[static_cast<std::size_t>(a)], q = knots[static_cast<std::size_t>(b)];
    if (rods)
      (void)system.joints().create(DistanceSpec{.p = p, .q = q});
    else
      (void)system.bonds().create(p, q, SpringLaw{.stiffness = 1e4});
  };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      if (i + 1 < side) tie(i * side + j, (i + 1) * side + j);
      if (j + 1 < side) tie(i * side + j, i * side + j + 1);
    }
  system.particles().nail(knots[0]), system.particles().nail(knots[static_cast<std::size_t>((side - 1) * side)]);
  return system;
}

void begin(benchmark::State& state, bool rods) {
  const int side = static_cast<int>(state.range(0));
  double first = 1e300, later = 1e300;
  for (auto _ : state) {
    System system = make_cloth(side, rods);
    double start = now_ms();
    (void)system.step(1.0 / 120);
    first = std::min(first, now_ms() - start);
    for (int step = 0; step < 4; ++step) {
      start = now_ms();
      (void)system.step(1.0 / 120);
      later = std::min(later, now_ms() - start);
    }
  }
  state.counters["first_step_ms"] = first;
  state.counters["later_step_ms"] = later;
}

/// Names are first_step/KIND/SIDE: bench/run_bench.py reads them.
const bool registered = [] {
  for (const bool rods : {false, true})
    for (const int side : {32, 100, 223}) {
      if (rods && side > 100) continue;
      benchmark::RegisterBenchmark((std::string("first_step/") + (rods ? "rods" : "springs")).c_str(),
                                   [=](benchmark::State& state) { begin(state, rods); })
          ->Arg(side)
          ->Iterations(side > 100 ? 1 : 2)
          ->Unit(benchmark::kMillisecond);
    }
  return true;
}();

}  // namespace
}  // namespace iota::bench
