// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"
#include "solver/stage.h"

#include <span>

namespace iota::solver {

/// The sides of rows with bounds (RowLaw): at a bound, or free. A primal-dual active set (Hintermueller, Ito, Kunisch
/// 2002): at each iteration a row is at the bound beyond which lambda + g / (natural compliance) lies, or free. All
/// rows change at once while that reduces the number of wrong ones, else one at a time, lowest first, which cannot
/// cycle (Judice and Pires 1994). A cone switches as one row does, between its own states. States and multipliers are in
/// the pools.
class ActiveSet {
 public:
  /// Sets sides from the multipliers of the last step; no other state is kept between steps.
  void begin(Problem&, const Stage&);
  /// Switches rows between bounds and free, by positions x and multipliers; returns whether any changed. Rows within
  /// the tolerance do not change.
  bool choose(Problem&, const Stage&, const Vec3* x);
  /// Number of rows that became free since `begin`.
  static int count_met(const Problem&);

  /// Selects bounded rows for a projection of velocities: those with one bound and no gap ...
  static void begin_impulses(Problem&);
  /// ... or those that the latest solve left free, including motors at their speed and sticking friction.
  static void begin_impulses_after_step(Problem&);
  /// Releases rows whose impulse, by unknown, has the wrong sign; returns whether there were any.
  static bool release_impulses(Problem&, std::span<const double> impulses);

 private:
  template <class C>
  static void begin_cone(ConstraintPool<C>&, std::size_t item, const Problem&, const Stage&);
  template <class C>
  static ConeState choose_state(const ConstraintPool<C>&, std::size_t item, const Problem&, const Stage&,
                                const Vec3* x);
  template <class C>
  static void set_cone(ConstraintPool<C>&, std::size_t item, ConeState);

  int fewest_wrong_ = 0, stalled_ = 0;
};

}  // namespace iota::solver
