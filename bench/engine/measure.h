// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <vector>

namespace iota::bench {

/// Steps the system once an iteration; says what a link and step costs and what the result is worth (gap, energy).
inline void step_and_judge(benchmark::State& state, System& system, int links, int hz) {
  const auto processor_ms = [] { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const double start = system.energy().total();
  double gap = 0, highest = start, end = start, largest_kinetic = 0, iterations = 0;
  int iterations_max = 0, fallbacks = 0, unconverged = 0, substeps_max = 0;
  const bool each = links >= 512;  // reading the clock twice would show in shorter steps
  std::vector<double> step_ms;
  step_ms.reserve(static_cast<std::size_t>(state.max_iterations));
  for (auto _ : state) {
    const double begin = each ? processor_ms() : 0;
    const StepReport report = system.step(1.0 / hz);
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

}  // namespace iota::bench
