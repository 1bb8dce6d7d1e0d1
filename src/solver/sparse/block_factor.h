// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/block_pattern.h"
#include "solver/sparse/leaves.h"

#include <span>
#include <vector>

namespace iota::solver {

/// Values of a matrix with a `BlockPattern`, and its factors in place: L D L' for symmetric matrices, L U (without
/// pivoting) for structurally symmetric ones. Nothing is allocated after `reset`.
class BlockFactor {
 public:
  /// Sizes the storage. The pattern must outlive the factor.
  void reset(const BlockPattern& pattern);
  /// Whether a factorization costs several times what a solution does: not on chains, but in nets and among many-point
  /// bodies.
  bool is_dear() const { return diagonals_.size() + lower_.size() > 10 * std::size_t{pattern_->unknown_count()}; }
  /// Makes room for a pattern that has followed a change.
  void grow();

  /// Sets all values to zero; `symmetric` tells which triangles are going to be filled.
  void clear(bool symmetric);

  /// Diagonal blocks, and those below them, at the offsets that the pattern gives.
  double* diagonals() { return diagonals_.data(); }
  double* lower() { return lower_.data(); }
  /// Blocks above the diagonal of an unsymmetric matrix: element (i, j) lies where (j, i) does in `lower`.
  double* upper() { return upper_.data(); }

  /// Factors in place; returns how many pivots have the wrong sign (not finite counts as wrong). Zero means that the
  /// matrix has as many positive and negative pivots as a minimum under constraints should.
  int factorize() { return factorize({}); }

  /// Solves in place: right-hand side in, solution out, both in the pattern's unknowns.
  void solve(std::span<double> unknowns);
  /// The same along with `factorize`, for one pass over the factors less: substitution forward while they are made, and
  /// then backward.
  int factorize(std::span<double> unknowns);
  void finish(std::span<double> unknowns);

 private:
  /// How many of the vertices from one on are alike and do not couple: 2, or 1; 0: it couples with more than one node.
  int leaves_from(std::size_t vertex) const;
  template <int Pivot, int N>
  Leaves<Pivot, N> leaves(std::size_t first, double* unknowns);
  template <int Pivot, bool Symmetric>
  int eliminate(const BlockPattern::Vertex&);
  template <bool Symmetric>
  int eliminate(const BlockPattern::Panel&);
  void place_rows(const BlockPattern::Panel&);
  template <bool Symmetric>
  void gather(const BlockPattern::Panel&);
  template <bool Symmetric, int Pivot>
  int factor_columns(const BlockPattern::Vertex&, std::uint32_t at, std::uint32_t rows);
  template <bool Symmetric>
  void store(const BlockPattern::Panel&);
  template <bool Symmetric>
  void update_later(const BlockPattern::Panel&);
  void size_panels();
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
  std::vector<double> unscaled_;  // L D of the front at hand, symmetric case

  // The panel at hand: by columns, `stride_` apart.
  std::vector<double> panel_lower_, panel_upper_, product_;  // L; L D or U'; what is left for later vertices
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> row_of_;  // of a vertex: where its unknowns begin in the panel
};

}  // namespace iota::solver
