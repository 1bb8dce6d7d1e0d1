// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

#include <vector>

namespace iota::solver {

/// The rate of each row by the velocities of a problem, at a fraction of the way of targets, in the order of the pools; targets rest.
inline void find_row_rates(const Problem& problem, double fraction, std::vector<double>& rates) {
  rates.clear();
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (const C& c : pool.items) {
      double sum[C::rows] = {};
      const Gradients<C> gradients(c, problem.position.data(), fraction);
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        gradients.of_node(i, rows);
        for (int r = 0; r < C::rows; ++r) sum[r] += dot(rows[r], problem.velocity[c.nodes[i]]);
      }
      rates.insert(rates.end(), sum, sum + C::rows);
    }
  });
}

}  // namespace iota::solver
