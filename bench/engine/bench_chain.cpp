// SPDX-License-Identifier: Apache-2.0
//
// The chain released horizontally, one step an iteration: what one link costs, and what it is worth (gap, energy).
#include "bench/engine/chain.h"
#include "bench/engine/measure.h"

#include <benchmark/benchmark.h>

#include <string>

namespace iota::bench {
namespace {

/// Long chains are cut short so that the run stays short; the counter simulated_s says how short.
int steps_of(int links, int hz) { return hz * (links <= 2000 ? 10 : links <= 4096 ? 2 : 1); }

void fall(benchmark::State& state, bool rods, IntegrationMode mode, int hz) {
  const int links = static_cast<int>(state.range(0));
  Chain chain(links, rods, mode);
  step_and_judge(state, chain.system, links, hz);
}

/// Names are chain/LINK/MODE/HZ/LINKS: bench/run_bench.py reads them.
const bool registered = [] {
  for (const bool rods : {false, true})
    for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping})
      for (const int hz : {120, 60})
        for (const int links : {8, 64, 512, 2000, 4096, 16384, 100000}) {
          if (links == 100000 && (hz != 120 || !rods)) continue;
          const std::string name = std::string("chain/") + (rods ? "rod" : "two_point") + '/' +
                                   (mode == IntegrationMode::robust ? "robust" : "energy_keeping") + '/' +
                                   std::to_string(hz);
          benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { fall(state, rods, mode, hz); })
              ->Arg(links)
              ->Iterations(steps_of(links, hz))
              ->MeasureProcessCPUTime()
              ->Unit(benchmark::kMicrosecond);
        }
  return true;
}();

}  // namespace
}  // namespace iota::bench
