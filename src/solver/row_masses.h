// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

#include <cstdint>
#include <vector>

namespace iota::solver {

/// The sums of the rows of the mass matrix, kg: of each node what it would weigh if all moved alike. Zero where couplings
/// of the other sign cancel it, as at the rim of a balanced wheel.
inline void sum_row_masses(const Problem& problem, std::vector<double>& sum) {
  sum.assign(problem.mass.begin(), problem.mass.end());
  for (const auto& c : problem.mass_couplings) sum[c.a] += c.mass, sum[c.b] += c.mass;
}

/// visit(mass, a, b): the entries of the mass matrix, off-diagonal ones twice.
template <class Visit>
void for_each_mass(const Problem& problem, Visit visit) {
  for (std::uint32_t i = 0; i < problem.size(); ++i) visit(problem.mass[i], i, i);
  for (const auto& c : problem.mass_couplings) visit(c.mass, c.a, c.b), visit(c.mass, c.b, c.a);
}

}  // namespace iota::solver
