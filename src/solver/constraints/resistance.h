// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/bilinear.h"

namespace iota::solver {

/// Resistance against rolling or spinning, where two bodies touch: a direction of one of them and one of the other, at right angles
/// in the middle of the step, turn against each other only beyond a torque. Its row is a rate with bounds, a share of what the
/// contacts carry: see ActiveSet::follow_reactions.
struct ResistanceConstraint : BilinearConstraint {
  static constexpr std::uint32_t none = 0xffffffff;
  std::array<std::uint32_t, 2> contacts{none, none};  ///< in their pool: both places where the bodies touch, or one
  double share = 0;                                   ///< N m for each N
  /// The bodies meet in this step: in the mid-point scheme a part of the impulse comes with the velocities at its end.
  bool begins = false;

  /// The bound of its torque, N m (of its impulse, N m s): reaction_of(contact), N (N s).
  template <class ReactionOf>
  double bound(ReactionOf reaction_of) const {
    double sum = 0;
    for (const std::uint32_t contact : contacts)
      if (contact != none) sum += reaction_of(contact);
    return share * sum;
  }
};

}  // namespace iota::solver
