// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "array_argument.h"
#include "binders.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace iota::bindings {

/// A batch of the engine; valid while the script's function for it runs.
template <class Batch>
struct BatchView {
  nb::object system_object;
  SystemObject* system = nullptr;
  const Batch* batch = nullptr;

  /// `name`: its name in scripts.
  const Batch& use(const char* name) const {
    if (!batch) raise_runtime(std::string("a ") + name + " is valid only until its function returns");
    return *batch;
  }
};

/// Copies, which the script may keep: shape (n,), and (n, 3).
inline nb::object make_array(std::vector<double> numbers) {
  auto* const kept = new std::vector<double>(std::move(numbers));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>, nb::c_contig>(kept->data(), {kept->size()}, owner));
}
inline nb::object copy_rows(const double* rows, std::size_t count) {
  return nb::cast(make_vector3_array(std::vector<double>(rows, rows + 3 * count)));
}

/// Calls a function with a view and reads the returned forces. `row`: the meaning of a row. No forces if it raises.
template <class View>
void ask_for_forces(const std::shared_ptr<ScriptFunction>& function, View view, const char* row) {
  const auto& batch = *view.batch;
  SystemObject* const system = view.system;
  std::fill_n(batch.force, 3 * batch.count, 0.0);
  system->guard(function, BondId{}, [&] {
    view.system_object = nb::find(system);
    nb::object shown = nb::cast(std::move(view));
    struct Expire {
      nb::object shown;
      ~Expire() {  // a kept view must not keep the system alive
        View& it = *nb::inst_ptr<View>(shown);
        it.batch = nullptr;
        it.system_object.reset();
      }
    } expire{shown};
    nb::object array;
    const nb::object result = function->function(shown);
    const auto rows = view_rows(result, batch.count, ("the forces of " + function->what).c_str(), row, array);
    std::copy(rows.begin(), rows.end(), batch.force);
  });
}

}  // namespace iota::bindings
