// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/general/dense.h"
#include "solver/problem.h"

#include <vector>

namespace iota::solver {

/// Which row of a problem: the place of its type in the list of constraint types, its item there, its row.
struct RowName {
  std::size_t pool = 0, item = 0;
  int row = 0;
};

/// The Jacobian G of the constraints that hold at the problem's positions, with its singular value decomposition. Columns
/// are scaled by L^-T where M = L L' is the mass matrix, rows to length 1: singular values are free of units.
struct ConstraintSpectrum {
  static constexpr double rank_tolerance = 1e-8;  ///< positions meet constraints to about 1e-10

  std::vector<RowName> names;  ///< of the rows
  std::size_t unknowns = 0, rank = 0;
  Svd svd;  ///< u complete: (rows, rows); v: in scaled coordinates, padded

  /// Combinations of rows that vanish, as sparse as elimination makes them: (redundancy, rows), largest entry 1.
  Dense repeated_rows() const;
  /// Condition of [I G'; G -compliance], which is what a step solves but for stiffness.
  double kkt_condition(double compliance = 1e-12) const;
};

/// O(rows^2 unknowns).
ConstraintSpectrum calc_spectrum(const Problem&);
/// How many rows `calc_spectrum` would decompose.
std::size_t count_rows_that_hold(const Problem&);

}  // namespace iota::solver
