// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/constraint_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace iota::solver {

/// Expects the derivatives of a cone's equations to be those of finite differences. at: multipliers, then values.
template <ConeConstraint C>
void expect_derivatives(const C& c, ConeState state, const std::array<double, 6>& at, const double* natural) {
  const ConeEquations e = c.equations(state, at.data(), at.data() + 3, natural);
  for (std::size_t k = 0; k < 6; ++k) {
    constexpr double small = 1e-6;
    std::array<double, 6> moved = at;
    moved[k] += small;
    const ConeEquations after = c.equations(state, moved.data(), moved.data() + 3, natural);
    for (std::size_t r = 0; r < 3; ++r)
      EXPECT_NEAR((after.value[r] - e.value[r]) / small, k < 3 ? e.by_multiplier[r][k] : e.by_value[r][k - 3], 1e-5);
  }
}

}  // namespace iota::solver
