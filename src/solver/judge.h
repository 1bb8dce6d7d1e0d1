// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/energy_balance.h"
#include "solver/settings.h"

namespace iota::solver {

/// A solved (sub-)step before it is committed.
struct Trial {
  Scheme scheme = Scheme::mid_point;
  bool is_finest = false;  ///< shorter parts will not be tried
  bool is_refined = false;
  bool is_conservative = true;  ///< nothing outside does work
  bool drives_rows = false;     ///< targets move: their work is known to first order only
};

enum class Verdict : std::uint8_t {
  accept,  ///< energy within the tolerance is left; of the end-point scheme the rest is removed from the motion
  refine,  ///< solve it to round-off, and judge again
  reject   ///< try shorter parts or, where these are the shortest, the next attempt
};

/// Whether a step makes more energy than it may. Iterates that did not converge, bodies that have jumped by half a turn and
/// too long steps on curves all show in that.
Verdict judge(const Trial&, const StepEnergy&);

}  // namespace iota::solver
