// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system_object.h"

#include <nanobind/nanobind.h>

#include <utility>

namespace iota::bindings {

/// The state of a Python `Places`.
struct PlacesObject {
  explicit PlacesObject(nb::object of) : system_object(std::move(of)), system(to_system(system_object)) {}

  Places& use() {
    if (system == nullptr) throw nb::value_error("these questions have no system any more");
    (void)system->use();
    return places;
  }

  nb::object system_object;  ///< keeps the system alive
  SystemObject* system = nullptr;
  Places places = system->engine.places();
};

}  // namespace iota::bindings
