// SPDX-License-Identifier: Apache-2.0
// The Python module `iota._core`: the engine and the server under their own names. `iota` re-exports it.
#include "binders.h"
#include "explained_calls.h"
#include "places_object.h"

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
