// SPDX-License-Identifier: Apache-2.0
//
// Saving, restoring, hashing and showing a chain.
#include "bench/engine/chain.h"

#include <benchmark/benchmark.h>

namespace iota::bench {
namespace {

constexpr int warm_steps = 10;

Chain falling_chain(int links) {
  Chain chain(links, true, IntegrationMode::robust);
  for (int i = 0; i < warm_steps; ++i) benchmark::DoNotOptimize(chain.system.step(1.0 / 120));
  return chain;
}
void count(benchmark::State& state, int links) {
  state.counters["us_per_link"] =
      benchmark::Counter(1e-6 * links, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["links"] = links;
}

void save(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  const Chain chain = falling_chain(links);
  std::size_t bytes = 0;
  for (auto _ : state) {
    const Snapshot snapshot = chain.system.snapshot();
    bytes = snapshot.bytes.size();
    benchmark::DoNotOptimize(snapshot.bytes.data());
  }
  count(state, links);
  state.counters["bytes_per_link"] = static_cast<double>(bytes) / links;
}
BENCHMARK(save)->Name("snapshot/save")->Arg(64)->Arg(4096);

void restore(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  Chain chain = falling_chain(links);
  const Snapshot snapshot = chain.system.snapshot();
  for (auto _ : state) chain.system.restore(snapshot);
  count(state, links);
}
BENCHMARK(restore)->Name("snapshot/restore")->Arg(64)->Arg(4096);

void hash(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  const Chain chain = falling_chain(links);
  for (auto _ : state) benchmark::DoNotOptimize(chain.system.state_hash());
  count(state, links);
}
BENCHMARK(hash)->Name("snapshot/hash")->Arg(64)->Arg(4096);

/// What the script hands to the server each frame.
void poses(benchmark::State& state) {
  const int links = static_cast<int>(state.range(0));
  const Chain chain = falling_chain(links);
  for (auto _ : state) benchmark::DoNotOptimize(chain.system.viewer().poses());
  count(state, links);
}
BENCHMARK(poses)->Name("snapshot/poses")->Arg(64)->Arg(4096);

}  // namespace
}  // namespace iota::bench
