// SPDX-License-Identifier: Apache-2.0
//
// Breaking and rejoining a chain while it runs.
#include "bench/engine/chain.h"

#include <benchmark/benchmark.h>

namespace iota::bench {
namespace {

/// One separate and one combine of the hinge in the middle, no step between: the edits themselves.
void separate_combine(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  Chain chain(links, true, IntegrationMode::robust);
  const auto middle = static_cast<std::size_t>(links / 2);
  const ParticleId upper = chain.parts.lower[middle - 1], lower = chain.parts.upper[middle];
  for (auto _ : state) {
    benchmark::DoNotOptimize(chain.system.separate(upper, lower));
    benchmark::DoNotOptimize(chain.system.combine(upper, lower));
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
    if (edit) benchmark::DoNotOptimize(chain.system.separate(upper, lower));
    benchmark::DoNotOptimize(chain.system.step(h));
    if (edit) benchmark::DoNotOptimize(chain.system.combine(upper, lower));
    benchmark::DoNotOptimize(chain.system.step(h));
  }
  state.counters["us_per_link_step"] =
      benchmark::Counter(2e-6 * links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["links"] = links;
}
BENCHMARK_CAPTURE(step_after_edit, edited, true)->Name("restructure/step_edited")->Arg(64)->Arg(512)->Arg(4096);
BENCHMARK_CAPTURE(step_after_edit, plain, false)->Name("restructure/step_plain")->Arg(64)->Arg(512)->Arg(4096);

/// Building the whole chain: bodies, particles, hinges, nail.
void build(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Chain(links, true, IntegrationMode::robust));
  state.counters["us_per_link"] =
      benchmark::Counter(1e-6 * links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["links"] = links;
}
BENCHMARK(build)->Name("restructure/build")->Arg(8)->Arg(64)->Arg(512)->Arg(4096)->Arg(16384);

}  // namespace
}  // namespace iota::bench
