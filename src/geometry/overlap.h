// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/function_ref.h"

#include <iota/vec3.h>

namespace iota::geometry {

/// A convex set by its farthest point in a direction, which is not zero.
using Support = FunctionRef<Vec3(const Vec3& direction)>;

/// Whether two convex sets have a point in common. What is apart by less than 1e-9 of their extent counts as touching.
bool overlap(Support a, Support b);

}  // namespace iota::geometry
