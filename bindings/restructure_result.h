// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system_object.h"

namespace iota::bindings {

/// The engine's report with the system that its ids belong to.
struct RestructureResult {
  nb::object system_object;
  SystemObject* system = nullptr;
  RestructureReport report;
};

}  // namespace iota::bindings
