// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cmath>
#include <limits>

namespace iota::solver {

/// Maximum in which a NaN counts as infinite (std::max would drop it).
struct Largest {
  double value = 0;
  void add(double v) {
    if (!(v <= value)) value = v == v ? v : std::numeric_limits<double>::infinity();
  }
};

inline double largest_component(const Vec3& v) {
  Largest l;
  l.add(std::abs(v.x)), l.add(std::abs(v.y)), l.add(std::abs(v.z));
  return l.value;
}

}  // namespace iota::solver
