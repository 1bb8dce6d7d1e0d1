// SPDX-License-Identifier: Apache-2.0
// The Python module `iota._core`: the engine and the server under their own names. `iota` re-exports it.
#include "binders.h"
#include "explained_calls.h"
#include "places_object.h"

namespace iota::bindings {

// Each has a file of its name.
void bind_vector(nb::module_&);
void bind_shapes(nb::module_&);
void bind_reports(nb::module_&);
void bind_recording(nb::module_&);
void bind_system(nb::module_&);
void bind_body(nb::module_&);
void bind_particle(nb::module_&);
void bind_laws(nb::module_&);
void bind_bonds(nb::module_&);
void bind_angle_springs(nb::module_&);
void bind_fields(nb::module_&);
void bind_grip(nb::module_&);
void bind_constraints(nb::module_&);
void bind_restructuring(nb::module_&);
void bind_arrays(nb::module_&);
void bind_parts(nb::module_&);
void bind_articulates(nb::module_&);
void bind_edits(nb::module_&);
void bind_emitters(nb::module_&);
void bind_server(nb::module_&);
void bind_solvers(nb::module_&);

}  // namespace iota::bindings

NB_MODULE(_core, module) {
  using namespace iota::bindings;
  module.doc() = "The engine and the server of iota. Import `iota` instead.";
  module.attr("version") = IOTA_VERSION;
  register_errors();
  bind_vector(module);
  bind_shapes(module);
  bind_reports(module);
  bind_recording(module);
  bind_system(module);
  bind_body(module);
  bind_particle(module);
  bind_laws(module);
  bind_bonds(module);
  bind_angle_springs(module);
  bind_fields(module);
  bind_grip(module);
  bind_constraints(module);
  bind_restructuring(module);
  bind_arrays(module);
  bind_parts(module);
  bind_places(module);
  bind_articulates(module);
  bind_edits(module);
  bind_emitters(module);
  bind_server(module);
  bind_solvers(module);
  explain_calls(module);
}
