// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/block_pattern.h"
#include "solver/sparse/leaves.h"
#include "solver/sparse/panel_product.h"

#include <span>
#include <vector>

namespace iota::solver {

/// Element (r, k) of L21 and (k, r) of U12 in SIMD lanes: both triangles go through the same operations.
struct TwoTriangles {
  LanesOf<2>::Type value;
};

/// The values of a matrix that are stored: those of the lower triangle alone, or of both.
enum class Storage : std::uint8_t { symmetric, general };

/// Values of a matrix with a `BlockPattern`, and its factors in place: L D L' for symmetric matrices, L U (without
/// pivoting) for structurally symmetric ones. Nothing is allocated after `reset`.
class BlockFactor {
 public:
  /// Sizes the storage. The pattern must outlive the factor.
  void reset(const BlockPattern& pattern);
  /// Whether a factorization costs several times as much as a solution: not on chains, but in nets and for many-point
  /// bodies.
  bool is_dear() const { return diagonals_.size() + lower_.size() > 10 * std::size_t{pattern_->unknown_count()}; }
  /// Resizes for a pattern that has followed a change, or for the changed copy of one.
  void grow(const BlockPattern&);

  /// Sets all values to zero; in symmetric storage only the lower triangle is then filled.
  void clear(Storage);
  Storage storage() const { return symmetric_ ? Storage::symmetric : Storage::general; }

  /// Diagonal blocks, and those below them, at the pattern's offsets.
  double* diagonals() { return diagonals_.data(); }
  double* lower() { return lower_.data(); }
  /// Blocks above the diagonal of an unsymmetric matrix: element (i, j) is at the place of (j, i) in `lower`.
  double* upper() { return upper_.data(); }

  /// Factors in place; returns the number of pivots with the wrong sign (or not finite). Zero means that a symmetric
  /// matrix has the positive and negative pivots of a constrained minimum. In general storage these are the pivots of
  /// L U. Mean gradients differ little from those of the end, so that the pivots tell the same of the symmetric part. A
  /// row with a column of another direction (sliding friction) is judged by the product of both: a wrong sign may then
  /// also mean that the row jams, and a clamped Hessian does not change it.
  int factorize() { return factorize({}); }

  /// Solves in place: replaces the right-hand side by the solution, both in the pattern's unknowns.
  void solve(std::span<double> unknowns);
  /// The same together with `factorize`, with one pass over the factors less: forward substitution during the
  /// factorization, then backward.
  int factorize(std::span<double> unknowns);
  void finish(std::span<double> unknowns);

 private:
  template <int Pivot, int N>
  Leaves<Pivot, N> leaves(std::size_t first, double* unknowns);
  template <int Pivot, bool Symmetric>
  int eliminate(const BlockPattern::Vertex&);
  template <bool Symmetric>
  int eliminate(const BlockPattern::Panel&);
  void number_rows(const BlockPattern::Panel&);
  template <class Visit>
  void for_each_below(const BlockPattern::Panel&, Visit) const;
  template <bool Symmetric>
  void gather(const BlockPattern::Panel&);
  template <bool Symmetric, int Pivot>
  int factor_columns(const BlockPattern::Vertex&, std::uint32_t at, std::uint32_t rows);
  template <bool Symmetric>
  void store(const BlockPattern::Panel&);
  template <bool Symmetric>
  void update_later(const BlockPattern::Panel&);
  template <bool Symmetric>
  void update_columns(const BlockPattern::Panel&, const BlockPattern::Vertex& last, std::uint32_t begin,
                      std::uint32_t end);
  std::size_t index_in_panel(std::uint32_t row, std::uint32_t column) const {
    return index_in_strips(row, column, stride_);
  }
  static std::uint32_t strips_in(std::uint32_t rows) { return (rows + strip_rows - 1) / strip_rows; }
  void size_fronts();
  /// visit(vertex) for each in an order in which the right-hand side can be substituted forward.
  template <class Visit>
  void for_each_forward(Visit visit) const;
  template <int Pivot>
  void forward(const BlockPattern::Vertex&, double* b) const;
  template <int Pivot, bool Symmetric>
  void backward(const BlockPattern::Vertex&, double* b) const;

  const BlockPattern* pattern_ = nullptr;
  bool symmetric_ = true;
  std::vector<double> diagonals_, lower_, upper_;
  std::vector<double> unscaled_;     // L D of the front at hand, symmetric case
  std::vector<TwoTriangles> front_;  // the front at hand, unsymmetric case

  // The panel at hand: strips of rows, `stride_` apart, each by columns.
  std::vector<double> panel_lower_, panel_upper_;  // L; L D or U'
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> row_of_;  // of a vertex: where its unknowns begin in the panel
};

}  // namespace iota::solver
