// SPDX-License-Identifier: Apache-2.0
#pragma once

// A new shape needs a struct and its name in the variant of iota/shapes.h, a header here, a line below, a line in
// protocol/shapes.json, its name in python/iota/__init__.py, a file and a line in web/src/scene/shapes. No other code has
// to name it.
#include "shape/box.h"
#include "shape/capsule.h"
#include "shape/cone.h"
#include "shape/cylinder.h"
#include "shape/ellipsoid.h"
#include "shape/half_space.h"
#include "shape/mesh.h"
#include "shape/sphere.h"
#include "shape/torus.h"

#include <utility>

namespace iota::shape {

/// Calls visit(S{}) for every shape, in their order.
template <class Visit>
void for_each_shape(Visit visit) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (visit(std::variant_alternative_t<I, Shape>{}), ...);
  }(std::make_index_sequence<std::variant_size_v<Shape>>{});
}

static_assert([]<std::size_t... I>(std::index_sequence<I...>) {
  return (Known<std::variant_alternative_t<I, Shape>> && ...);
}(std::make_index_sequence<std::variant_size_v<Shape>>{}));

}  // namespace iota::shape
