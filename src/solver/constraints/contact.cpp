// SPDX-License-Identifier: Apache-2.0
#include "solver/constraints/contact.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

/// The friction that would hold the point at its present slip: z = lambda + (s - c_t lambda) / k.
struct TrialFriction {
  TrialFriction(const ContactConstraint& c, const double* multipliers, const double* g, const double* compliances)
      : natural(std::max(compliances[1], compliances[2])) {
    for (std::size_t i = 0; i < 2; ++i)
      force[i] = multipliers[1 + i] + (g[1 + i] - c.compliance * multipliers[1 + i]) / natural;
    size = std::hypot(force[0], force[1]);
  }
  double natural;  ///< k, m/N
  double force[2], size;
};

constexpr ConeState slips{ConeState::Mode::slips, 1};

}  // namespace

ConeState ContactConstraint::state_of(const double* multipliers) const {
  constexpr double at_edge = 1 - 1e-6;
  if (!(multipliers[0] < 0)) return {ConeState::Mode::open};
  if (never_slips) return {};
  const double size = std::hypot(multipliers[1], multipliers[2]);
  const double edge = largest_friction(multipliers);
  if (size < at_edge * edge) return {};
  // A place that slips has the friction of the edge. With more of it, it sticks, if static friction allows that at all.
  const bool holds = size > edge / at_edge || size == 0;
  return holds && static_friction > friction ? ConeState{} : slips;
}

// A contact that closes without a slip sticks: noise would be the direction of its friction.
ConeState ContactConstraint::switch_state(ConeState now, const double* multipliers, const double* g,
                                          const double* natural, double tolerance) const {
  if (now.mode == ConeState::Mode::open && !(g[0] < -tolerance)) return now;
  const double push = -multipliers[0];
  if (natural[0] * push - (g[0] + compliance_of(0) * push) < -tolerance) return {ConeState::Mode::open};
  if (never_slips) return {};
  const TrialFriction trial(*this, multipliers, g, natural);
  // Static friction may hold a place that comes to rest and would turn back. It came to rest within the step before, after which
  // friction and load moved it on: at most by the speed that these give in half a step.
  const bool turns = drag_before[0] * trial.force[0] + drag_before[1] * trial.force[1] < 0;
  const double hold = turns ? 2 * largest_hold(multipliers) + largest_friction(multipliers) : largest_hold(multipliers);
  if (now.slips())
    return trial.natural * (trial.size - (turns ? hold : largest_friction(multipliers))) < -tolerance ? ConeState{}
                                                                                                      : now;
  return trial.natural * (trial.size - hold) > tolerance ? slips : ConeState{};
}

ConeEquations ContactConstraint::equations(ConeState state, const double* multipliers, const double* g,
                                           const double* natural) const {
  ConeEquations e{.by_value = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  for (std::size_t r = 0; r < 3; ++r) {
    const double soft = compliance_of(static_cast<int>(r));
    e.value[r] = g[r] - soft * multipliers[r], e.by_multiplier[r][r] = -soft;
  }
  if (!state.slips()) return e;
  const TrialFriction trial(*this, multipliers, g, natural);
  const double k = trial.natural;
  const double bound = state.direction == 0 ? 0 : largest_friction(multipliers);
  const double d[2] = {trial.size > 0 ? trial.force[0] / trial.size : 0,
                       trial.size > 0 ? trial.force[1] / trial.size : 0};
  // With a trial within the circle, which is about to stick, the step would turn too far.
  const double part = trial.size > 0 ? std::min(1.0, bound / trial.size) : 0;
  for (std::size_t i = 0; i < 2; ++i) {
    e.value[1 + i] = k * (bound * d[i] - multipliers[1 + i]);
    if (state.direction == 0)
      e.by_multiplier[1 + i][0] = k * drags[i];
    else
      e.by_multiplier[1 + i][0] = multipliers[0] < 0 ? -k * friction * d[i] : 0;
    for (std::size_t j = 0; j < 2; ++j) {
      const double across = part * ((i == j ? 1 : 0) - d[i] * d[j]);
      e.by_value[1 + i][1 + j] = across;
      e.by_multiplier[1 + i][1 + j] = (k - compliance) * across - (i == j ? k : 0);
    }
  }
  return e;
}

}  // namespace iota::solver
