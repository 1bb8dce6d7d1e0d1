// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system_object.h"

namespace iota::bindings {

/// The name of a function in the script.
std::string function_name(nb::handle function);

/// The address of compiled code: a number, a Numba cfunc, a ctypes function; 0 for anything else.
std::uintptr_t address_of(nb::handle code);

/// Keyword arguments as parameters of a law; None is the distance of the two ends (NaN).
std::vector<LawParameter> to_parameters(const nb::kwargs& arguments);
nb::dict to_dict(const std::vector<LawParameter>& parameters);

/// The law that a word names or an expression spells; an expression is made once for each text and set of parameters.
/// `parameters` are its defaults.
LawId law_of_text(SystemObject& system, const std::string& text, const std::vector<LawParameter>& parameters);

/// A stiffness has no useful default: ValueError if a predefined law gets none.
void require_stiffness(const System& engine, LawId law, const std::vector<LawParameter>& given);

}  // namespace iota::bindings
