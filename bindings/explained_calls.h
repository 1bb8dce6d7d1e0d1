// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

namespace iota::bindings {

/// Makes every function, method, property and type of a module, as it is now, answer wrong arguments with a sentence that
/// names the wrong word, instead of nanobind's list of C++ overloads. `iota.arguments` writes the sentences.
/// Call it last: what is bound later keeps nanobind's texts.
void explain_calls(nanobind::module_& module);

}  // namespace iota::bindings
