// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "system_object.h"

#include "base/parallel.h"

#include <nanobind/stl/vector.h>

#include <algorithm>
#include <exception>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace iota::bindings {

namespace {

std::vector<StepReport> step_all(const std::vector<nb::object>& given, double dt, int count, int threads) {
  std::vector<SystemObject*> systems;
  std::set<SystemObject*> known;
  for (const nb::object& each : given) {
    systems.push_back(to_system(each));
    if (!known.insert(systems.back()).second) {
      const std::string text = "systems[" + std::to_string(systems.size() - 1) + "] is there twice";
      throw nb::value_error(text.c_str());
    }
  }
  const Parallel parallel(threads);
  for (SystemObject* const system : systems) system->prepare_step(dt, count);
  std::vector<StepReport> reports(systems.size());
  {
    const nb::gil_scoped_release unlocked;
    const auto grain = std::max<std::size_t>(1, systems.size() / (8 * static_cast<std::size_t>(parallel.threads())));
    parallel.for_each(systems.size(), grain, [&](std::size_t i) {
      SystemObject& system = *systems[i];
      const std::thread::id owner = std::exchange(system.owner, std::this_thread::get_id());  // for its functions
      reports[i] = system.advance(dt, count);
      system.owner = owner;
    });
  }
  std::exception_ptr failed;
  for (std::size_t i = 0; i < systems.size(); ++i) {
    try {
      systems[i]->finish_step(reports[i]);
    } catch (...) {
      if (!failed) failed = std::current_exception();
    }
  }
  if (failed) std::rethrow_exception(failed);
  return reports;
}

}  // namespace

void bind_batches(nb::module_& module) {
  module.def("step_all", &step_all, "systems"_a, "dt"_a = 1.0 / 120, "count"_a = 1, "threads"_a = 0,
             "See `iota.step_all`.");
}

}  // namespace iota::bindings
