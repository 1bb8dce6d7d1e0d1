// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// A sparse factor L D L' of the Delassus matrix J W J': J are rows that each act on at most two rigid bodies, W the inverse
/// masses of these. It has a block for two ties that share a body; a tie has up to three rows. Rows that
/// depend on earlier ones get no impulse.
class DelassusFactor {
 public:
  /// A tie acts on a body.
  struct Incidence {
    std::uint32_t tie, body;
  };
  /// After a change of structure. False if many ties share a body, so that the factor would be large.
  bool analyze(std::uint32_t tie_count, std::span<const Incidence>, std::uint32_t body_count);

  /// couple(i, j): the matrix of the rows of tie i by those of tie j. Rows and columns that a tie does not have are zero.
  template <class Couple>
  void factorize(Couple couple) {
    begin();
    for (const Entry& entry : entries_) (entry.is_diagonal ? pivots_ : below_)[entry.slot] = couple(entry.i, entry.j);
    factorize();
  }
  /// Replaces the right-hand side of each tie by its solution.
  void solve(std::span<Vec3>) const;

 private:
  struct Entry {
    std::uint32_t i, j, slot;
    bool is_diagonal;
  };
  void begin();
  void factorize();

  std::vector<std::uint32_t> order_;    // the ties as they are eliminated
  std::vector<std::uint32_t> first_;    // of the blocks below each pivot
  std::vector<std::uint32_t> rows_;     // of each block: its place in the order
  std::vector<std::uint32_t> targets_;  // for each two blocks of a column: the block that their product changes
  std::vector<Entry> entries_;          // of the matrix
  std::vector<Mat3> pivots_, below_;    // then the inverses of D, and L
  std::vector<Mat3> column_;            // before it is divided by its pivot
  std::vector<Vec3> least_;             // pivots that count are larger
  mutable std::vector<Vec3> x_;
};

}  // namespace iota::solver
