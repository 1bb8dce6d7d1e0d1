// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"
#include "solver/stage.h"

#include <span>

namespace iota::solver {

/// On which side rows with bounds (RowLaw) are: at a bound, or free. A primal-dual active set (Hintermueller, Ito, Kunisch
/// 2002): at each iteration a row is at the bound beyond which lambda + g / (natural compliance) lies, or free. All rows
/// change at once while that lessens how many are wrong, else one at a time, lowest first, which cannot cycle (Judice and
/// Pires 1994). Sides and multipliers live in the pools.
class ActiveSet {
 public:
  /// Sides as the multipliers from the last step tell: nothing else needs to be remembered between steps.
  void begin(Problem&, const Stage&);
  /// Moves rows between their bounds and freedom, as positions x and multipliers tell; returns whether any did. What is
  /// within the tolerance stays where it is.
  bool choose(Problem&, const Stage&, const Vec3* x);
  /// Rows that came from a bound to their equation since `begin`.
  static int count_met(const Problem&);

  /// Which bounded rows take part in a projection of velocities. `as_solved`: those that the latest solve left free, be
  /// they motors that have reached their speed or friction that sticks; else those that forbid something and have no gap.
  static void begin_impulses(Problem&, bool as_solved);
  /// Lets go of rows whose impulse, by unknown, went the wrong way; returns whether there were any.
  static bool release_impulses(Problem&, std::span<const double> impulses);

 private:
  int fewest_wrong_ = 0, stalled_ = 0;
};

}  // namespace iota::solver
