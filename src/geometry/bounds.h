// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

namespace iota::geometry {

/// A box along the axes, m.
struct Bounds {
  Vec3 low, high;
};

}  // namespace iota::geometry
