// SPDX-License-Identifier: Apache-2.0
// Bonds by law and pairwise forces: what one costs, built in, as an expression and as code.
#include <iota/system.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

namespace {

using namespace iota;

/// A fluid whose particles have about 30 neighbors within the cut-off.
void particles(benchmark::State& state, bool written) {
  System system(SystemOptions{.gravity = {}});
  system.set_threads(1);
  const int side = static_cast<int>(state.range(0)), n = side * side * side;
  constexpr double cutoff = 2.5, neighbors = 30;
  const double spacing = cutoff * std::cbrt(4.18879 / neighbors);
  std::mt19937 random(1);
  const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  for (int i = 0; i < n; ++i)
    system.particles().create(system.bodies().create(),
                              spacing * Vec3{double(i % side), double(i / side % side), double(i / side / side)} +
                                  0.05 * Vec3{number(), number(), number()},
                              1, Vec3{number(), number(), number()});
  const std::vector<LawParameter> parameters{{"depth", 1}, {"size", 1}};
  const LawId law = written ? system.laws().create("energy = 4*depth*((size/r)^12 - (size/r)^6)", {"", parameters})
                            : system.laws().find("lennard_jones");
  system.pairs().create({law, parameters, {}}, {.cutoff = cutoff});
  for (int i = 0; i < 20; ++i) (void)system.step(0.004);
  for (auto _ : state) benchmark::DoNotOptimize(system.step(0.004));
  state.counters["particle_steps/s"] =
      benchmark::Counter(n * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(particles, built_in, false)->Arg(16)->Arg(32)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(particles, expression, true)->Arg(16)->Arg(32)->Unit(benchmark::kMillisecond);

/// A shoal, as in the study of that name but without its script: each fish has about 20 neighbors within the cut-off.
void boids(benchmark::State& state) {
  System system(SystemOptions{.gravity = {}});
  system.set_threads(1);
  const auto n = static_cast<int>(state.range(0));
  constexpr double cutoff = 0.9, neighbors = 20;
  const double half = 0.5 * cutoff * std::cbrt(4.18879 / neighbors * n);
  std::mt19937 random(1);
  std::uniform_real_distribution within(-half, half), speed(-0.5, 0.5);
  for (int i = 0; i < n; ++i) {
    const Vec3 place{within(random), within(random), within(random)};
    system.particles().create(system.bodies().create(), place, 0.1,
                              Vec3{1 + speed(random), speed(random), speed(random)});
  }
  const std::vector<LawParameter> parameters{{"attraction", 0.03},
                                             {"attraction_range", 0.8},
                                             {"repulsion", 0.4},
                                             {"repulsion_range", 0.15},
                                             {"alignment", 0.02}};
  system.pairs().create({system.laws().find("attract_repel"), parameters, {}}, {.cutoff = cutoff});
  for (int i = 0; i < 3; ++i) (void)system.step(1.0 / 60);
  for (auto _ : state) benchmark::DoNotOptimize(system.step(1.0 / 60));
  state.counters["boid_steps/s"] =
      benchmark::Counter(n * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(boids)->Arg(1000)->Arg(100'000)->Unit(benchmark::kMillisecond);

void free_fall(benchmark::State& state) {
  System system;
  system.set_threads(1);
  for (int i = 0; i < 32768; ++i) system.particles().create(system.bodies().create(), {0.1 * i, 0, 0});
  for (int i = 0; i < 3; ++i) (void)system.step(0.004);
  for (auto _ : state) benchmark::DoNotOptimize(system.step(0.004));
  state.counters["particle_steps/s"] =
      benchmark::Counter(32768.0 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(free_fall)->Unit(benchmark::kMillisecond);

/// A net of bonds between free particles; ns a bond.
void bonds(benchmark::State& state, int way, bool implicit) {
  System system(SystemOptions{.gravity = {}});
  system.set_threads(1);
  constexpr int n = 4096;
  std::vector<ParticleId> p;
  for (int i = 0; i < 2 * n; ++i)
    p.push_back(system.particles().create(system.bodies().create(), {0.1 * (i / 2), 0.1 * (i % 2), 0}));
  const std::vector<LawParameter> parameters{{"k", 10}, {"r0", 0.1}};
  const LawId laws[] = {
      system.laws().find("spring"), system.laws().create("energy = 0.5*k*(r - r0)^2", {"", parameters}),
      system.laws().create(+[](double r, double, double, const double* q) { return -q[0] * (r - q[1]); },
                           {"", parameters})};
  for (int i = 0; i < n; ++i) {
    SharedLaw law{laws[way], {}, implicit};
    if (way == 0) law.parameters = {{"stiffness", 10}, {"length", 0.1}};
    system.bonds().create(p[2 * i], p[2 * i + 1], law);
  }
  for (int i = 0; i < 5; ++i) (void)system.step(0.004);
  for (auto _ : state) benchmark::DoNotOptimize(system.step(0.004));
  state.counters["us_per_bond"] = benchmark::Counter(n * 1e-6 * static_cast<double>(state.iterations()),
                                                     benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(bonds, spring_held, 0, false);
BENCHMARK_CAPTURE(bonds, expression_held, 1, false);
BENCHMARK_CAPTURE(bonds, compiled_held, 2, false);
BENCHMARK_CAPTURE(bonds, spring_implicit, 0, true);
BENCHMARK_CAPTURE(bonds, expression_implicit, 1, true);

}  // namespace
