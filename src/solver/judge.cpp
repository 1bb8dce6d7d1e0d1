// SPDX-License-Identifier: Apache-2.0
#include "solver/judge.h"

#include <cmath>

namespace iota::solver {

namespace {

/// The energy that a step may make beyond the slack of its solve: shares of the kinetic, the total energy and the external work.
struct Limit {
  double of_kinetic = 0, of_total = 0, of_work = 0;

  double of(const StepEnergy& step) const {
    return of_kinetic * step.motion() + of_total * step.whole() + of_work * std::abs(step.external_work);
  }
};

// The end-point scheme dissipates, and makes energy only by forces of negative curvature. The mid-point rule keeps energy with
// quadratic rows only: on a curve or surface a too long step may make any amount (half of a random scene's in one
// step). The share of the total is for motions that reverse, whose kinetic energy vanishes.
constexpr Limit no_limit{};
constexpr Limit of_mid_point{.of_kinetic = 0.05, .of_total = 1e-3, .of_work = 1};
constexpr Limit of_shortest_parts{.of_kinetic = 0.1, .of_total = 1e-9, .of_work = 1};
constexpr Limit of_driven_rows{.of_kinetic = 1.5, .of_total = 1e-6, .of_work = 1};

const Limit& limit_of(const Trial& trial) {
  const bool is_end_point = trial.scheme == Scheme::end_point;
  if (is_end_point && trial.is_finest) return of_shortest_parts;
  if (trial.drives_rows) return of_driven_rows;
  if (is_end_point) return trial.is_conservative ? no_limit : of_shortest_parts;
  return of_mid_point;
}

}  // namespace

Verdict judge(const Trial& trial, const StepEnergy& step) {
  if (!(step.gained() > step.round_off)) return Verdict::accept;
  if (trial.scheme == Scheme::end_point && trial.is_conservative && !trial.is_refined) return Verdict::refine;
  return step.gained() > step.slack + limit_of(trial).of(step) ? Verdict::reject : Verdict::accept;
}

}  // namespace iota::solver
