// SPDX-License-Identifier: Apache-2.0
//
// Breaking and rejoining a chain while it runs.
#include "bench/engine/chain.h"
#include "scenes/loose_bodies.h"

#include <iota/step_times.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <random>
#include <vector>

namespace iota::bench {
namespace {

/// One separate and one combine of the hinge in the middle, no step between: the edits themselves.
void separate_combine(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  Chain chain(links, true, IntegrationMode::robust);
  const auto middle = static_cast<std::size_t>(links / 2);
  const ParticleId upper = chain.parts.lower[middle - 1], lower = chain.parts.upper[middle];
  for (auto _ : state) {
    benchmark::DoNotOptimize(chain.system.edits().separate(upper, lower));
    benchmark::DoNotOptimize(chain.system.edits().combine(upper, lower));
  }
  state.counters["us_per_edit"] =
      benchmark::Counter(2e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["links"] = links;
}
BENCHMARK(separate_combine)->Name("restructure/separate_combine")->Arg(8)->Arg(64)->Arg(512)->Arg(4096)->Arg(16384);

/// The same with a step after each edit, so that what an edit makes the solver redo is counted. `plain` takes the same
/// two steps without edits: the difference is the price of restructuring.
void step_after_edit(benchmark::State& state, bool edit) {
  const int links = static_cast<int>(state.range(0));
  Chain chain(links, true, IntegrationMode::robust);
  const auto middle = static_cast<std::size_t>(links / 2);
  const ParticleId upper = chain.parts.lower[middle - 1], lower = chain.parts.upper[middle];
  constexpr double h = 1e-4;  // so short that the halves hardly part, and that every step costs about the same
  for (auto _ : state) {
    if (edit) benchmark::DoNotOptimize(chain.system.edits().separate(upper, lower));
    benchmark::DoNotOptimize(chain.system.step(h));
    if (edit) benchmark::DoNotOptimize(chain.system.edits().combine(upper, lower));
    benchmark::DoNotOptimize(chain.system.step(h));
  }
  state.counters["us_per_link_step"] =
      benchmark::Counter(2e-6 * links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["links"] = links;
}
BENCHMARK_CAPTURE(step_after_edit, edited, true)->Name("restructure/step_edited")->Arg(64)->Arg(512)->Arg(4096);
BENCHMARK_CAPTURE(step_after_edit, plain, false)->Name("restructure/step_plain")->Arg(64)->Arg(512)->Arg(4096);

/// A cut, a step, the rejoining of what has not moved apart yet, a step: what the slowest of a hundred edits costs beyond
/// the two steps, edits and the following of the solver's structure together.
void cut_and_rejoin(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  Chain chain(links, true, IntegrationMode::robust);
  constexpr double h = 1e-6;  // the halves stay together, so that every step costs the same
  const auto now_ms = [] { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  std::mt19937 random(1);
  std::vector<double> cut_ms, rejoin_ms, step_ms;
  for (auto _ : state) {
    const auto at = 1 + random() % static_cast<std::size_t>(links - 1);
    const ParticleId upper = chain.parts.lower[at - 1], lower = chain.parts.upper[at];
    const double start = now_ms();
    (void)chain.system.step(h);
    const double plain = now_ms();
    (void)chain.system.edits().separate(upper, lower);
    (void)chain.system.step(h);
    const double cut = now_ms();
    (void)chain.system.edits().combine(upper, lower);
    (void)chain.system.step(h);
    const double rejoined = now_ms();
    step_ms.push_back(plain - start), cut_ms.push_back(cut - plain), rejoin_ms.push_back(rejoined - cut);
  }
  std::sort(step_ms.begin(), step_ms.end());
  const double step = step_ms[step_ms.size() / 2];
  const auto beyond = [&](std::vector<double>& list, double part) {
    std::sort(list.begin(), list.end());
    return list[static_cast<std::size_t>(part * static_cast<double>(list.size() - 1))] - step;
  };
  state.counters["step_ms"] = step;
  state.counters["cut_ms_p50"] = beyond(cut_ms, 0.5), state.counters["cut_ms_p99"] = beyond(cut_ms, 0.99);
  state.counters["rejoin_ms_p50"] = beyond(rejoin_ms, 0.5), state.counters["rejoin_ms_p99"] = beyond(rejoin_ms, 0.99);
}
BENCHMARK(cut_and_rejoin)->Name("restructure/cut_and_rejoin")->Arg(10000)->Iterations(100);

/// Links of a chain at rest into one rigid body, within one edit, time of a link; and the taking apart of that body, part by
/// part from random places, time of a part.
void make_one_body(benchmark::State& state, bool apart) {
  const int links = static_cast<int>(state.range(0));
  std::mt19937 random(1);
  for (auto _ : state) {
    state.PauseTiming();
    Chain chain(links, false, IntegrationMode::robust);
    (void)chain.system.step(1e-4);
    std::vector<BodyId> parts(chain.parts.links.begin() + 1, chain.parts.links.end());
    std::shuffle(parts.begin(), parts.end(), random);
    if (!apart) state.ResumeTiming();
    chain.system.edits().begin();
    for (int i = 1; i < links; ++i)
      (void)chain.system.edits().combine(chain.parts.links[0], chain.parts.links[static_cast<std::size_t>(i)]);
    (void)chain.system.edits().end();
    if (apart) {
      state.ResumeTiming();
      for (const BodyId part : parts) (void)chain.system.edits().separate(chain.parts.links[0], part);
    }
  }
  state.counters["us_per_link"] =
      benchmark::Counter(1e-6 * links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(make_one_body, combine, false)
    ->Name("restructure/one_body")
    ->Arg(200)
    ->Arg(800)
    ->Arg(5100)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make_one_body, separate, true)
    ->Name("restructure/part_by_part")
    ->Arg(200)
    ->Arg(800)
    ->Arg(5100)
    ->Unit(benchmark::kMillisecond);

/// Building the whole chain: bodies, particles, hinges, nail.
void build(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Chain(links, true, IntegrationMode::robust));
  state.counters["us_per_link"] =
      benchmark::Counter(1e-6 * links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["links"] = links;
}
BENCHMARK(build)->Name("restructure/build")->Arg(8)->Arg(64)->Arg(512)->Arg(4096)->Arg(16384);

/// Loose boxes of which a tenth of the ropes between neighbors changes in each step, and what share of the steps the
/// islands and the patterns of their matrices take. 500 ropes leave islands of a few boxes; with 1350, half of all pairs
/// of neighbors, most boxes are one island.
void loose_bodies(benchmark::State& state, bool changes) {
  System system({.gravity = {}, .mode = IntegrationMode::robust, .threads = 1});
  scenes::LooseBodies loose(system, 10, static_cast<std::size_t>(state.range(0)));
  StepTimes times;
  for (int i = 0; i < 20; ++i) {
    if (changes) loose.change(loose.ropes.size() / 10);
    (void)system.step(1.0 / 120);
  }
  int iterations = 0, substeps = 0, unconverged = 0;
  for (auto _ : state) {
    if (changes) loose.change(loose.ropes.size() / 10);
    const TimedSteps timed(times);
    const StepReport report = system.step(1.0 / 120);
    iterations = std::max(iterations, report.iterations_max), substeps = std::max(substeps, report.substeps_max);
    unconverged += report.unconverged;
  }
  const double steps = static_cast<double>(state.iterations());
  state.counters["step_ms"] = 1e3 * times.total() / steps;
  state.counters["islands_ms"] = 1e3 * times.analyze / steps;
  state.counters["share_of_islands"] = times.analyze / times.total();
  state.counters["islands"] = static_cast<double>(system.islands().size());
  state.counters["iterations_max"] = iterations, state.counters["substeps_max"] = substeps;
  state.counters["unconverged"] = unconverged;
}
BENCHMARK_CAPTURE(loose_bodies, change, true)
    ->Name("restructure/loose_bodies")
    ->Arg(500)
    ->Arg(700)
    ->Arg(1350)
    ->Iterations(50)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(loose_bodies, stay, false)
    ->Name("restructure/loose_bodies_tied")
    ->Arg(500)
    ->Arg(1350)
    ->Iterations(50)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace iota::bench
