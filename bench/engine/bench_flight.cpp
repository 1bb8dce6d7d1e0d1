// SPDX-License-Identifier: Apache-2.0
//
// Loose boxes that spin in flight: what a step costs, what it costs to make and remove them, and their memory.
#include <iota/system.h>

#include <benchmark/benchmark.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <fstream>
#include <string>
#include <vector>

namespace iota::bench {
namespace {

std::vector<BodyId> make_boxes(System& system, int count) {
  std::vector<BodyId> boxes;
  boxes.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const BodyId box = system.bodies().create(Box{{1, 0.8, 0.6}}, {.position = {2.0 * (i % 100), 2.0 * (i / 100), 0}});
    system.bodies().set_angular_velocity(box, {0.3, 0.2 * (i % 5), 1});
    boxes.push_back(box);
  }
  return boxes;
}

SystemOptions options_of(IntegrationMode mode) { return {.mode = mode, .threads = 1}; }

void step_in_flight(benchmark::State& state, IntegrationMode mode) {
  System system(options_of(mode));
  (void)make_boxes(system, static_cast<int>(state.range(0)));
  for (int i = 0; i < 5; ++i) (void)system.step(1.0 / 120);
  for (auto _ : state) (void)system.step(1.0 / 120);
}
BENCHMARK_CAPTURE(step_in_flight, robust, IntegrationMode::robust)
    ->Name("flight/robust")
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step_in_flight, energy_keeping, IntegrationMode::energy_keeping)
    ->Name("flight/energy_keeping")
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step_in_flight, accurate, IntegrationMode::accurate)
    ->Name("flight/accurate")
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);

/// With a step before they go, as only that knows them.
void make_and_remove(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  System system(options_of(IntegrationMode::energy_keeping));
  for (auto _ : state) {
    const std::vector<BodyId> boxes = make_boxes(system, count);
    (void)system.step(1.0 / 120);
    for (const BodyId box : boxes) system.bodies().destroy(box);
    (void)system.step(1.0 / 120);
  }
}
BENCHMARK(make_and_remove)->Name("flight/make_and_remove")->Arg(10000)->Unit(benchmark::kMillisecond);

#ifdef __GLIBC__
double allocated() {
  const auto all = mallinfo2();
  return static_cast<double>(all.uordblks + all.hblkhd);
}
double resident() {
  malloc_trim(0);
  std::ifstream file("/proc/self/status");
  double kilobytes = 0;
  for (std::string word; file >> word;)
    if (word == "RssAnon:") file >> kilobytes;
  return 1024 * kilobytes;
}

/// By the allocator's counter, and by the process's resident memory. Run it by itself.
void memory_in_flight(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const double resident_before = resident(), allocated_before = allocated();
    System system(options_of(IntegrationMode::energy_keeping));
    (void)make_boxes(system, count);
    for (int i = 0; i < 4; ++i) (void)system.step(1.0 / 120);
    state.counters["bytes_per_box"] = (allocated() - allocated_before) / count;
    state.counters["resident_per_box"] = (resident() - resident_before) / count;
  }
}
BENCHMARK(memory_in_flight)->Name("memory/loose_box")->Arg(10000)->Iterations(1)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace iota::bench
