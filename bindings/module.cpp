// SPDX-License-Identifier: Apache-2.0
// The Python module `iota._core`: the engine and the server under their own names. `iota` re-exports it.
#include "binders.h"
#include "binders_of_folder.h"
#include "explained_calls.h"

namespace iota::bindings {

// bind_NAME is in the file of that name. The list of all is made from the folder (cmake/python.cmake).
#define IOTA_DECLARE_BINDER(NAME) void bind_##NAME(nb::module_&);
IOTA_FIRST_BINDERS(IOTA_DECLARE_BINDER)
IOTA_OTHER_BINDERS(IOTA_DECLARE_BINDER)

}  // namespace iota::bindings

NB_MODULE(_core, module) {
  using namespace iota::bindings;
  module.doc() = "The engine and the server of iota. Import `iota` instead.";
  module.attr("version") = IOTA_VERSION;
  register_errors();
#define IOTA_CALL_BINDER(NAME) bind_##NAME(module);
  IOTA_FIRST_BINDERS(IOTA_CALL_BINDER)
  IOTA_OTHER_BINDERS(IOTA_CALL_BINDER)
  explain_calls(module);
}
