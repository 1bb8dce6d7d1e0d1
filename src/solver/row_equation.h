// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"
#include "solver/stage.h"

namespace iota::solver {

/// The equation of a free row: value - softness * lambda = 0.
struct RowEquation {
  double value, softness;
};

/// In the mid-point scheme a spring uses its mean stretch, so that its energy is kept exactly.
inline RowEquation equation_of(const RowLaw& law, const RowState& state, double g, const Stage& stage) {
  if (law.hold) g -= state.start + law.rate * stage.h;
  if (!law.is_compliant()) return {g, 0};
  const double part = stage.midpoint ? 0.5 : 1;
  const double stiffness = 1 / law.compliance, damping = law.damping / stage.h;
  const double total = part * stiffness + damping;
  const double before = law.hold ? 0 : state.start;
  return {g + ((1 - part) * stiffness - damping) / total * before, 1 / total};
}

struct Bounds {
  double lower, upper;
};

inline Bounds bounds_of(const RowLaw& law, const Stage& stage) {
  if (stage.is_projection()) return {law.lower_impulse(), law.upper_impulse()};
  return {law.lower, law.upper};
}

/// Whether all rows of an item are at a bound of zero, so that it has no effect.
template <class C>
bool is_out_of_play(const ConstraintPool<C>& pool, std::size_t item) {
  for (std::size_t row = item * C::rows; row < (item + 1) * C::rows; ++row)
    if (pool.states[row].side == 0 || pool.multipliers[row] != 0) return false;
  return true;
}

}  // namespace iota::solver
