// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cmath>

namespace iota::laws {

/// N. A larger force counts as not finite: squares of the resulting motion would overflow.
inline constexpr double largest_force = 1e30;

inline bool is_force(double x, double y, double z) { return std::abs(x) + std::abs(y) + std::abs(z) < largest_force; }
inline bool is_force(const Vec3& f) { return is_force(f.x, f.y, f.z); }

}  // namespace iota::laws
