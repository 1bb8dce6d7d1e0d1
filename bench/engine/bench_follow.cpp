// SPDX-License-Identifier: Apache-2.0
//
// What the edits of a user's hand cost on a long chain while it runs: grab, move, cut, close, call off, rejoin, let go.
#include <iota/system.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace iota::bench {
namespace {

/// Processor times of edits with the step after each, by the edit's name.
class EditTimes {
 public:
  explicit EditTimes(System& system) : system_(system) {}

  template <class Edit>
  void measure(const std::string& name, Edit edit) {
    const double start = now_ms();
    edit();
    (void)system_.step(1e-4);  // so short that all steps cost about the same
    by_edit_[name].push_back(now_ms() - start);
  }

  /// Counters NAME_ms_p50 and NAME_ms_p99: beyond the same quantile of steps without an edit, while somebody holds the chain. And of
  /// these steps the median, step_ms, and how far 99 % stay within beyond it, step_ms_scatter.
  void report(benchmark::State& state) {
    for (const auto& [name, times] : by_edit_)
      for (const auto& [suffix, part] : {std::pair{"_ms_p50", 0.5}, {"_ms_p99", 0.99}})
        if (name != "step" && name != "held_step")
          state.counters[name + suffix] = quantile(name, part) - quantile("held_step", part);
    for (const char* name : {"step", "held_step"}) {
      const double median = quantile(name, 0.5);
      state.counters[name + std::string("_ms")] = median;
      state.counters[name + std::string("_ms_scatter")] = quantile(name, 0.99) - median;
    }
  }

 private:
  static double now_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
  double quantile(const std::string& name, double part) {
    std::vector<double>& times = by_edit_[name];
    std::sort(times.begin(), times.end());
    return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
  }

  System& system_;
  std::map<std::string, std::vector<double>> by_edit_;
};

/// A chain of rods in zigzag, its first end nailed: in a straight one a loop would be singular.
struct Zigzag {
  System system{{.mode = IntegrationMode::robust, .threads = 1}};
  std::vector<BodyId> links;
  std::vector<ParticleId> upper, lower;  ///< of each link; lower[i] is hinged with upper[i + 1]

  explicit Zigzag(int count) {
    const auto joint = [](int i) { return Vec3{0.07 * i, 0.07 * (i % 2), 0.03 * (i % 3)}; };
    for (int i = 0; i < count; ++i) {
      links.push_back(system.bodies().create());
      upper.push_back(system.particles().create(links.back(), joint(i), 0.05));
      lower.push_back(system.particles().create(links.back(), joint(i + 1), 0.05));
      system.bodies().set_rod(links.back(), 0.1, 0.005);
      if (i > 0) (void)system.edits().combine(lower[static_cast<std::size_t>(i) - 1], upper.back());
    }
    system.particles().nail(upper.front());
  }
};

enum class Scene { plain, held, damped };

/// A hundred rounds at random places. `held`: somebody else holds the chain all the time; `damped`: so is every tenth link.
void edit_by_hand(benchmark::State& state, Scene scene) {
  const int count = static_cast<int>(state.range(0));
  Zigzag chain(count);
  System& system = chain.system;
  const auto links = static_cast<std::size_t>(count);
  if (scene == Scene::held)
    (void)system.grips().create(chain.links[links / 3], {}, system.bodies().center_of_mass(chain.links[links / 3]));
  if (scene == Scene::damped)
    for (std::size_t i = 0; i < links; i += 10) system.bodies().set_damping(chain.links[i], 0.5);
  for (int i = 0; i < 10; ++i) (void)system.step(1e-4);

  EditTimes times(system);
  std::mt19937 random(1);
  for (auto _ : state) {
    const auto at = 1 + random() % (links - 100);
    const ParticleId upper = chain.lower[at - 1], lower = chain.upper[at];
    const ParticleId end = chain.lower[at + 20], other_end = chain.lower[at + 40];
    const BodyId link = chain.links[random() % links];
    const Vec3 place = system.bodies().center_of_mass(link);
    GripId grip;
    times.measure("step", [] {});
    (void)system.bodies().orientation(link);  // as drawing the last frame has done
    times.measure("grab", [&] { grip = system.grips().create(link, {}, place); });
    times.measure("held_step", [] {});
    times.measure("move", [&] { system.grips().move(grip, place + Vec3{0, 0, 1e-4}); });
    times.measure("close", [&] { (void)system.edits().combine(end, other_end, 0.1); });
    times.measure("call_off", [&] { (void)system.edits().separate(end, other_end); });
    times.measure("cut", [&] { (void)system.edits().separate(upper, lower); });
    times.measure("rejoin", [&] { (void)system.edits().combine(upper, lower); });
    times.measure("let_go", [&] { system.grips().destroy(grip); });
  }
  times.report(state);
}
BENCHMARK_CAPTURE(edit_by_hand, plain, Scene::plain)->Name("follow/plain")->Arg(10000)->Iterations(100);
BENCHMARK_CAPTURE(edit_by_hand, held, Scene::held)->Name("follow/held")->Arg(10000)->Iterations(100);
BENCHMARK_CAPTURE(edit_by_hand, damped, Scene::damped)->Name("follow/damped")->Arg(10000)->Iterations(100);

}  // namespace
}  // namespace iota::bench
