// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/cone.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace iota::solver {

/// Whether each row of a pool with laws (RowLaw) is an equation at present, or its multiplier is at a bound. ActiveSet
/// decides, and knows at which bound; all others only ask.
class RowStates {
 public:
  /// Makes all rows equations; of a pool without laws there are none.
  void reset(std::size_t rows) { rows_.assign(rows, {}); }
  void resize(std::size_t rows) { rows_.resize(rows); }
  void clear() { rows_.clear(); }

  bool is_equation(std::size_t row) const { return rows_.empty() || rows_[row].side == 0; }
  /// Whether it was at a bound at the start of the (sub-)step and is an equation now: a rope that is taut now.
  bool has_been_met(std::size_t row) const { return rows_[row].side == 0 && rows_[row].side_before != 0; }
  /// The state of a cone with three rows from this one on, the last of them along its tangent.
  ConeState cone(std::size_t first) const {
    const Row &normal = rows_[first], &tangent = rows_[first + 2];
    if (normal.side != 0) return {ConeState::Mode::open};
    return tangent.side == 0 ? ConeState{} : ConeState{ConeState::Mode::slips, tangent.side};
  }
  /// The value of a rate or compliant row at the start of the (sub-)step.
  double start(std::size_t row) const { return rows_[row].start; }
  /// By how much a rate row yields to a multiplier of 1 while the sides are sought; 0 in every solution.
  double yield(std::size_t row) const { return rows_[row].yield; }
  /// The rate at which the stretch of a spring that obeys its load changes at the end of an explicit sub-step, m/s.
  double stretching(std::size_t row) const { return rows_[row].stretching; }

 private:
  friend class ActiveSet;
  static constexpr std::int8_t as_it_moves = 2;
  struct Row {
    std::int8_t side = 0;         // -1, 1: its multiplier is at the lower, upper bound; 0: an equation
    std::int8_t side_before = 0;  // at the start of the (sub-)step
    bool off_speed = false;       // a rate row whose velocity there was not the target
    std::int8_t slips_on = 0;     // iterations for which a cone does not stick, as its force would pull then
    double start = 0, yield = 0;
    double before =
        0;  // at the start of an explicit sub-step: the speed of a row that slides, the multiplier of an equation
    std::int8_t next_side = as_it_moves;  // of an explicit sub-step
    double within = 0;                    // the multiplier at `ActiveSet::inner_time` of it
    double stretching = 0;
  };
  std::vector<Row> rows_;
};

}  // namespace iota::solver
