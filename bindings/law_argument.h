// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system_object.h"

namespace iota::bindings {

/// What a script calls a function.
std::string function_name(nb::handle function);

/// The address of compiled code: a number, a Numba cfunc, a ctypes function; 0 for anything else.
std::uintptr_t address_of(nb::handle code);

/// Keyword arguments as parameters of a law; None is the distance of the two ends (NaN).
std::vector<LawParameter> to_parameters(const nb::kwargs& arguments);
nb::dict to_dict(const std::vector<LawParameter>& parameters);

/// The law that a word names or an expression spells; an expression is made once for each text and set of parameters.
/// `parameters` are its defaults.
LawId law_of_text(SystemObject& system, const std::string& text, const std::vector<LawParameter>& parameters);

/// How stiff a bond is has no usual value: a predefined law does not choose one unasked. ValueError where it is not given.
void require_stiffness(const System& engine, LawId law, const std::vector<LawParameter>& given);

}  // namespace iota::bindings
