// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/general/dense.h"
#include "solver/problem.h"

#include <vector>

namespace iota::solver {

/// Identifies a row of a problem: index of its type in the list of constraint types, item, row.
struct RowName {
  std::size_t pool = 0, item = 0;
  int row = 0;
};

/// The Jacobian G of the active constraints at the problem's positions, with its singular value decomposition. Columns
/// are scaled by L^-T with the mass matrix M = L L', rows to length 1: singular values have no units.
struct ConstraintSpectrum {
  static constexpr double rank_tolerance = 1e-8;  ///< positions satisfy constraints to about 1e-10

  std::vector<RowName> names;  ///< of the rows
  std::size_t unknowns = 0, rank = 0;
  Svd svd;  ///< u complete: (rows, rows); v: in scaled coordinates, padded

  /// Vanishing combinations of rows, made sparse by elimination: (redundancy, rows), largest entry 1.
  Dense repeated_rows() const;
  /// Condition of [I G'; G -compliance], the matrix of a step without stiffness.
  double kkt_condition(double compliance = 1e-12) const;
};

/// O(rows^2 unknowns).
ConstraintSpectrum calc_spectrum(const Problem&);
/// The number of rows for `calc_spectrum`.
std::size_t count_rows_that_hold(const Problem&);

}  // namespace iota::solver
