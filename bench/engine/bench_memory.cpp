// SPDX-License-Identifier: Apache-2.0
//
// What a link takes, all told, by the process's resident memory; `of_the_script` are the ids that this benchmark keeps.
// Run by itself, since memory that earlier cases gave back is still the process's.
#include "bench/engine/chain.h"

#include <benchmark/benchmark.h>

#include <fstream>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <string>

namespace iota::bench {
namespace {

/// Resident bytes of this process that are no file's, less what the allocator holds in reserve (Linux with glibc; 0
/// elsewhere).
double resident() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ifstream file("/proc/self/status");
  double kilobytes = 0;
  for (std::string word; file >> word;)
    if (word == "RssAnon:") file >> kilobytes;
  return 1024 * kilobytes;
}

void chain_in_memory(benchmark::State& state, IntegrationMode mode) {
  const int links = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const double before = resident();
    Chain chain(links, false, mode);
    for (int i = 0; i < 4; ++i) (void)chain.system.step(1.0 / 120);
    state.counters["bytes_per_link"] = (resident() - before) / links;
    state.counters["of_the_script"] =
        static_cast<double>(chain.parts.links.capacity() * sizeof(BodyId) +
                            (chain.parts.upper.capacity() + chain.parts.lower.capacity()) * sizeof(ParticleId)) /
        links;
  }
}
BENCHMARK_CAPTURE(chain_in_memory, robust, IntegrationMode::robust)
    ->Name("memory/robust")
    ->Arg(100000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(chain_in_memory, energy_keeping, IntegrationMode::energy_keeping)
    ->Name("memory/energy_keeping")
    ->Arg(100000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace iota::bench
