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
/// From arrays (n, 3) and (k, 3). Does not check the numbers of vertices.
Mesh make_mesh(nb::handle vertices, nb::handle triangles);

}  // namespace iota::bindings
