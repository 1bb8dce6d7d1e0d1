// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "array_argument.h"
#include "binders.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace iota::bindings {

/// A batch of the engine's while the script's function for it runs; afterwards it is gone.
template <class Batch>
struct BatchView {
  nb::object system_object;
  SystemObject* system = nullptr;
  const Batch* batch = nullptr;

  /// `name`: what the script calls it.
  const Batch& use(const char* name) const {
    if (!batch) raise_runtime(std::string("a ") + name + " is good only until the function that was given it returns");
    return *batch;
  }
};

/// Copies, so that they may be kept: shape (n,), and (n, 3).
inline nb::object make_array(std::vector<double> numbers) {
  auto* const kept = new std::vector<double>(std::move(numbers));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>, nb::c_contig>(kept->data(), {kept->size()}, owner));
}
inline nb::object copy_rows(const double* rows, std::size_t count) {
  return nb::cast(make_vector3_array(std::vector<double>(rows, rows + 3 * count)));
}

/// Shows a view to a function and takes the forces that it returns. `row`: what has one. Where it raises there are none.
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
      ~Expire() {  // a view that is kept must not keep the system
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
