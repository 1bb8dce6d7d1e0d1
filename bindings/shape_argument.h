// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/shapes.h>

#include <nanobind/nanobind.h>

namespace iota::bindings {

namespace nb = nanobind;

/// TypeError that lists the shapes for anything else.
Shape to_shape(nb::handle value);
bool is_shape(nb::handle value);
nb::object from_shape(const Shape& shape);

}  // namespace iota::bindings
