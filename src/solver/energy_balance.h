// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/advance_report.h"
#include "solver/newton.h"

#include <algorithm>
#include <span>

namespace iota::solver {

/// The energies of a solved (sub-)step that is not committed, J.
struct StepEnergy {
  double kinetic_before = 0, total_before = 0;
  double kinetic = 0, total = 0;         ///< at its end
  double flight_before = 0, flight = 0;  ///< of both energies, the part of the center of mass of what flies freely
  double external_work = 0;              ///< of explicit forces, grips, drives and moving targets
  double dissipated = 0;                 ///< work of dampers, dashpots and friction
  double damped = 0;                     ///< of that, by forces: rows also have friction, and the slip of clutches
  double impact = 0;                     ///< upper bound of what rows that have just become active dissipate
  double terms = 0;  ///< size of the terms of the potential energy and of the work, whose sums may be none
  double round_off = 0;
  double slack = 0;      ///< what the tolerance of the solve explains, of energy that is made; with round-off
  double overdrawn = 0;  ///< of the slack: what compliant rows returned beyond what they had stored
  double recoil = 0;     ///< of the slack: what joints returned beyond a small share of the motion, stored or not

  /// The kinetic and the total energy that errors are a share of: how fast a thing flies changes nothing within it.
  double motion() const { return std::max(kinetic_before - flight_before, kinetic - flight); }
  double whole() const { return std::max(std::abs(total_before - flight_before), std::abs(total - flight)); }
  double missing() const { return total_before + external_work - dissipated - total; }
  double made() const { return -missing(); }
  /// Without what is dissipated, whose round-off is large in stiff dashpots: made for sure.
  double gained() const { return total - total_before - external_work; }
  /// The work of moving targets on rows that do not yield. Only the compliance of the rows limits these forces, so their
  /// work means nothing: everything that is missing, or made, beyond the energy of the motion counts as idle. An arm
  /// pulled beyond its reach took 5e8 J in one step, all of it lost; a nail that stood in a conflict returned 2e9 J.
  double idle_work() const {
    const double motion = std::max(kinetic_before, kinetic) + std::max(0.0, impact);
    return external_work > 0 ? std::clamp(missing() - motion, 0.0, external_work)
                             : std::clamp(missing() + motion, external_work, 0.0);
  }
  double size() const {
    return terms + std::abs(total_before) + std::abs(total) + std::abs(external_work - dissipated);
  }
};

/// The world outside acts on a problem in a step by these.
struct Outside {
  bool drives_rows = false;  ///< a target moves, or a row has a rate
  bool holds = true;         ///< by any row; otherwise it flies freely
};

/// The energy of a problem from one (sub-)step to the next, and what no law or force explains of its changes.
struct EnergyBalance {
  double kinetic = 0, total = 0;  ///< of the present state, J
  double terms = 0;               ///< size of the terms of the potential energy, see Problem::Potential
  double missing = 0;             ///< unexplained: lost, or made if negative, J
  double slack = 0;               ///< of what is made: within the tolerance of the solves, J

  /// Measures the state as a new start: differences are not counted.
  void measure(const Problem&, double fraction);
  /// After a change of places and velocities by some external work, J; what that does not explain is missing.
  void measure_change(const Problem&, double fraction, double work = 0);
  /// After a change of velocities alone; what the change takes is missing.
  void measure_kinetic(const Problem&);
  /// The energy that the tolerance of a solve may make if energies are of this size, J.
  static double tolerance(double kinetic, double size);
  /// Newton's solution is the end of the step, with the velocities of its scheme; the multipliers are those before it.
  StepEnergy of_solution(const Problem&, const Newton&, const Stage&, Outside,
                         std::span<const double> multipliers_before) const;
  /// Continues from the end of a step.
  void take(const StepEnergy&, AdvanceReport&);
  /// The end of a (sub-)step of h seconds with its corrections: reports what is missing as lost, or as made. A surplus within
  /// the slack is subtracted from `lost`, as its sign varies from step to step.
  void close(const Problem&, double reference_length, double h, AdvanceReport&);
};

}  // namespace iota::solver
