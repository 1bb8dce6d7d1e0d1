// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

#include <vector>

namespace iota::solver {

/// The sums of the rows of the mass matrix, kg: of each node what it would weigh if all moved alike. Zero where couplings
/// of the other sign cancel it, as at the rim of a balanced wheel.
inline void sum_row_masses(const Problem& problem, std::vector<double>& sum) {
  sum.assign(problem.mass.begin(), problem.mass.end());
  for (const auto& c : problem.mass_couplings) sum[c.a] += c.mass, sum[c.b] += c.mass;
}

}  // namespace iota::solver
