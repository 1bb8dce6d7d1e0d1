// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <span>
#include <string>

namespace iota::bindings {

namespace nb = nanobind;

/// The numbers of an array or nested sequence of shape (count, 3), as float64 in C order; `array` keeps them alive.
/// The ValueError contains `name`, the meaning of a row and the actual shape.
inline std::span<const double> view_rows(nb::handle values, std::size_t count, const char* name, const char* row,
                                         nb::object& array) {
  array = nb::module_::import_("numpy").attr("ascontiguousarray")(values, "float64");
  const auto view = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  if (view.ndim() != 2 || view.shape(0) != count || view.shape(1) != 3) {
    const std::string text = std::string(name) + " must have the shape (" + std::to_string(count) + ", 3), one row a " +
                             row + ", not " + nb::repr(array.attr("shape")).c_str();
    throw nb::value_error(text.c_str());
  }
  return {view.data(), 3 * count};
}

}  // namespace iota::bindings
