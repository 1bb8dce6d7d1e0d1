// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

namespace iota::bindings {

/// For every present function, method, property and type of a module, replaces nanobind's list of C++ overloads for
/// wrong arguments by a sentence that names the wrong one. `iota.arguments` writes the sentences. Call it last:
/// functions that are bound later keep nanobind's texts.
void explain_calls(nanobind::module_& module);

}  // namespace iota::bindings
