// SPDX-License-Identifier: Apache-2.0
//
// Many small articulates: what a crowd costs a step, and what taking it apart and putting it together costs.
#include "scenes/ragdoll.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>

namespace iota::bench {
namespace {

std::vector<scenes::Ragdoll> make_crowd(System& system, int count) {
  std::vector<scenes::Ragdoll> crowd;
  for (int i = 0; i < count; ++i) crowd.push_back(scenes::make_ragdoll(system, {2.0 * (i % 32), 3, 2.0 * (i / 32)}));
  for (scenes::Ragdoll& doll : crowd)
    system.particles().nail(doll.hinges[5].second);  // each hangs by a shoulder and swings
  return crowd;
}

/// One step at 60 Hz by the clock on the wall: threads count.
void fall(benchmark::State& state, IntegrationMode mode) {
  const int count = static_cast<int>(state.range(0));
  System system({.mode = mode, .threads = static_cast<int>(state.range(1))});
  (void)make_crowd(system, count);
  const double start = system.energy().total();
  double gap = 0, kinetic = 0, highest = start;
  double iterations = 0;
  int iterations_max = 0, fallbacks = 0, unconverged = 0;
  std::vector<double> step_ms;
  const std::clock_t processor = std::clock();
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    const StepReport report = system.step(1.0 / 60);
    step_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    gap = std::max(gap, report.worst_gap);
    kinetic = std::max(kinetic, report.energy.kinetic);
    highest = std::max(highest, report.energy.total());
    iterations += report.iterations_mean, iterations_max = std::max(iterations_max, report.iterations_max);
    fallbacks += report.fallbacks, unconverged += report.unconverged;
  }
  std::sort(step_ms.begin(), step_ms.end());
  state.counters["step_ms_p50"] = step_ms[step_ms.size() / 2];
  state.counters["step_ms_p99"] = step_ms[step_ms.size() * 99 / 100];
  // By the processors' clocks, since the one on the wall also counts what else the machine does.
  const double steps = static_cast<double>(state.iterations());
  const double spent_ms = 1e3 * static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC / steps;
  state.counters["core_ms"] = spent_ms / system.threads();
  state.counters["us_per_link_step"] = 1e3 * spent_ms / (20 * count);
  state.counters["iterations_mean"] = iterations / steps;
  state.counters["iterations_max"] = iterations_max;
  state.counters["simulated_s"] = steps / 60;
  state.counters["gap_m"] = gap;
  state.counters["energy_gain"] = (highest - start) / kinetic;
  state.counters["energy_change"] = (system.energy().total() - start) / kinetic;
  state.counters["fallbacks"] = fallbacks;
  state.counters["unconverged"] = unconverged;
}
BENCHMARK_CAPTURE(fall, robust, IntegrationMode::robust)
    ->Name("ragdolls/robust")
    ->Args({1000, 1})
    ->Args({1000, 2})
    ->Iterations(120)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fall, energy_keeping, IntegrationMode::energy_keeping)
    ->Name("ragdolls/energy_keeping")
    ->Args({1000, 1})
    ->Args({1000, 2})
    ->Iterations(120)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Rods that each swing on their own nail: what an island costs that has hardly anything in it.
void swing(benchmark::State& state, IntegrationMode mode) {
  System system({.mode = mode, .threads = 1});
  const auto count = static_cast<int>(state.range(0));
  for (int i = 0; i < count; ++i) {
    const double angle = 0.4 + 0.6 * std::fmod(0.618 * i, 1.0);
    const Vec3 top{0.4 * (i % 32), 3, 0.4 * (i / 32)};
    const Vec3 along{0.3 * std::sin(angle), -0.3 * std::cos(angle), 0.1 * std::sin(3 * angle)};
    const BodyId rod = system.bodies().create();
    system.particles().nail(system.particles().create(rod, top, 0.05));
    system.particles().create(rod, top + along, 0.05);
  }
  for (auto _ : state) (void)system.step(1.0 / 60);
  state.counters["us_per_body_step"] =
      benchmark::Counter(1e-6 * count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(swing, robust, IntegrationMode::robust)->Name("pendulums/robust")->Arg(1000)->Iterations(60);
BENCHMARK_CAPTURE(swing, energy_keeping, IntegrationMode::energy_keeping)
    ->Name("pendulums/energy_keeping")
    ->Arg(1000)
    ->Iterations(60);

/// One separate and one combine of a random hinge among 500 figures (10 000 bodies).
void separate_combine(benchmark::State& state) {
  System system;
  const std::vector<scenes::Ragdoll> crowd = make_crowd(system, 500);
  (void)system.step(1.0 / 60);
  std::mt19937 random(1);
  for (auto _ : state) {
    const scenes::Ragdoll& doll = crowd[random() % crowd.size()];
    const auto& [inner, outer] = doll.hinges[random() % doll.hinges.size()];
    benchmark::DoNotOptimize(system.edits().separate(inner, outer));
    benchmark::DoNotOptimize(system.edits().combine(inner, outer));
  }
  state.counters["pairs_per_s"] = benchmark::Counter(1, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(separate_combine)->Name("ragdolls/separate_combine");

}  // namespace
}  // namespace iota::bench
