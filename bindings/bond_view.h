// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system_object.h"

namespace iota::bindings {

/// The engine's state of a bond with the system that its ids belong to.
struct BondView {
  nb::object system_object;
  SystemObject* system = nullptr;
  std::shared_ptr<BondFunction> function;
  BondState state;
};

}  // namespace iota::bindings
