// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace iota::solver {

/// A small dense matrix, row-major.
struct Dense {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;

  Dense() = default;
  Dense(std::size_t row_count, std::size_t column_count)
      : rows(row_count), columns(column_count), values(row_count * column_count, 0.0) {}
  double& operator()(std::size_t i, std::size_t j) { return values[i * columns + j]; }
  double operator()(std::size_t i, std::size_t j) const { return values[i * columns + j]; }
  double* row(std::size_t i) { return values.data() + i * columns; }
  const double* row(std::size_t i) const { return values.data() + i * columns; }
};

/// L U = P A with partial pivoting.
class DenseLu {
 public:
  /// False if a pivot is below `tolerance` times the largest entry, or not finite: the matrix is nearly singular.
  bool factorize(Dense a, double tolerance = 1e-13);
  /// Replaces b by the solution.
  void solve(std::span<double> b) const;

 private:
  Dense lu_;
  std::vector<std::size_t> order_;
  mutable std::vector<double> permuted_;
};

/// A = U diag(s) V', s falling, as many as the smaller of rows and columns; U and V hold the vectors in their columns.
struct Svd {
  Dense u, v;
  std::vector<double> s;

  /// Singular values above `tolerance` times the largest.
  std::size_t rank(double tolerance) const;
  /// Least-squares solution of least norm, without directions below `tolerance` times the largest singular value. (The
  /// thesis, C.3: 1/w becomes 0 if w is nearly zero.)
  std::vector<double> solve(std::span<const double> b, double tolerance) const;
};

/// One-sided Jacobi rotations: small singular values have full relative accuracy. O(rows columns^2) a sweep,
/// some ten sweeps. Source: Hestenes 1958; Demmel and Veselic 1992.
Svd calc_svd(const Dense& a);

}  // namespace iota::solver
