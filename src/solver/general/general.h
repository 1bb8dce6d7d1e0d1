// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/solver.h>

#include <cmath>
#include <limits>

namespace iota::solver {

/// Largest |f_i|; infinite if one is not finite.
inline double largest(std::span<const double> f) {
  double worst = 0;
  for (const double v : f) {
    if (!std::isfinite(v)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, std::abs(v));
  }
  return worst;
}

std::unique_ptr<Solver> make_newton_raphson();

/// Throws std::runtime_error if this build has no SUNDIALS.
std::unique_ptr<Solver> make_kinsol();
bool has_kinsol();

}  // namespace iota::solver
