// SPDX-License-Identifier: Apache-2.0
//
// What a step costs in which hardly anything moves, and what the islands cost of bodies that are tied and parted.
#include <iota/step_times.h>
#include <iota/system.h>

#include <benchmark/benchmark.h>

#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace iota::bench {
namespace {

constexpr RestOptions soon{.after = 0.1, .speed = 0.01};

Vec3 place(int i) { return {2.0 * (i % 100), 2.0 * (i / 100), 0}; }

std::vector<BodyId> make_boxes(System& system, int count, BodyKind kind = BodyKind::dynamic) {
  std::vector<BodyId> boxes;
  for (int i = 0; i < count; ++i)
    boxes.push_back(system.bodies().create(Box{{1, 1, 1}}, {.position = place(i), .kind = kind}));
  return boxes;
}

void by_timer(System& system, int count) {
  (void)make_boxes(system, count);
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
}

void by_hand(System& system, int count) {
  for (const BodyId box : make_boxes(system, count)) system.bodies().set_kind(box, BodyKind::resting);
}

void from_a_snapshot(System& system, int count) {
  System other({.gravity = {}, .rest = soon});
  by_timer(other, count);
  system.restore(other.snapshot());
}

void particles(System& system, int count) {
  for (int i = 0; i < count; ++i) {
    const BodyId body = system.bodies().create();
    (void)system.particles().create(body, place(i));
  }
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
}

void fixed(System& system, int count) { (void)make_boxes(system, count, BodyKind::static_); }

/// With `moving` boxes beside them.
void rest(benchmark::State& state, void (*make)(System&, int)) {
  System system({.gravity = {}, .rest = soon});
  make(system, static_cast<int>(state.range(0)));
  const int moving = static_cast<int>(state.range(1));
  for (int i = 0; i < moving; ++i) {
    const BodyId box = system.bodies().create(Box{{1, 1, 1}}, {.position = {-5.0 * (i + 1), 0, 0}});
    system.bodies().set_angular_velocity(box, {0, 0, 2});
  }
  for (int i = 0; i < 5; ++i) (void)system.step(0.01);
  StepReport report;
  for (auto _ : state) report = system.step(0.01);
  state.counters["resting"] = report.resting;
}
#define STILL(make)                   \
  BENCHMARK_CAPTURE(rest, make, make) \
      ->Name("still/" #make)          \
      ->Args({10000, 0})              \
      ->Args({10000, 1})              \
      ->Args({0, 0})                  \
      ->Unit(benchmark::kMicrosecond)
STILL(by_timer);
STILL(by_hand);
STILL(from_a_snapshot);
STILL(particles);
STILL(fixed);

}  // namespace
}  // namespace iota::bench
