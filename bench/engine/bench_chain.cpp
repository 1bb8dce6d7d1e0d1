// SPDX-License-Identifier: Apache-2.0
//
// The chain released horizontally, one step an iteration: what one link costs, and what it is worth (gap, energy).
#include "bench/engine/chain.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

namespace iota::bench {
namespace {

/// Long chains are cut short so that the run stays short; the counter simulated_s says how short.
int steps_of(int links, int hz) { return hz * (links <= 2000 ? 10 : links <= 4096 ? 2 : 1); }

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void fall(benchmark::State& state, bool rods, IntegrationMode mode, int hz) {
  const int links = static_cast<int>(state.range(0));
  Chain chain(links, rods, mode);
  const double start = chain.system.energy().total();
  double gap = 0, highest = start, end = start, largest_kinetic = 0, iterations = 0;
  int iterations_max = 0, fallbacks = 0, unconverged = 0, substeps_max = 0;
  const bool each = links >= 512;  // reading the clock twice would show in shorter steps
  std::vector<double> step_ms;
  step_ms.reserve(static_cast<std::size_t>(steps_of(links, hz)));
  for (auto _ : state) {
    const double begin = each ? processor_ms() : 0;
    const StepReport report = chain.system.step(1.0 / hz);
    if (each) step_ms.push_back(processor_ms() - begin);
    gap = std::max(gap, report.worst_gap);
    end = report.energy.total();
    highest = std::max(highest, end);
    largest_kinetic = std::max(largest_kinetic, report.energy.kinetic);
    iterations += report.iterations_mean;
    iterations_max = std::max(iterations_max, report.iterations_max);
    substeps_max = std::max(substeps_max, report.substeps_max);
    fallbacks += report.fallbacks;
    unconverged += report.unconverged;
  }
  std::sort(step_ms.begin(), step_ms.end());
  const double steps = static_cast<double>(state.iterations());
  state.counters["us_per_link_step"] =
      benchmark::Counter(links * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["gap_m"] = gap;
  state.counters["energy_change"] = (end - start) / largest_kinetic;
  state.counters["energy_gain"] = (highest - start) / largest_kinetic;
  state.counters["iterations_mean"] = iterations / steps;
  state.counters["iterations_max"] = iterations_max;
  state.counters["substeps_max"] = substeps_max;
  state.counters["fallbacks"] = fallbacks;
  state.counters["unconverged"] = unconverged;
  if (each) {
    state.counters["step_ms_p50"] = step_ms[step_ms.size() / 2];
    state.counters["step_ms_p99"] = step_ms[step_ms.size() * 99 / 100];
  }
  state.counters["simulated_s"] = steps / hz;
  state.counters["links"] = links;
  state.counters["hz"] = hz;
}

/// Names are chain/LINK/MODE/HZ/LINKS: bench/run_bench.py reads them.
const bool registered = [] {
  for (const bool rods : {false, true})
    for (const auto mode : {IntegrationMode::robust, IntegrationMode::energy_keeping})
      for (const int hz : {120, 60})
        for (const int links : {8, 64, 512, 2000, 4096, 16384}) {
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
