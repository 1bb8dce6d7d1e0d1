// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace iota::solver {

/// Report of one step of one problem.
struct [[nodiscard]] AdvanceReport {
  int solves = 0;
  int iterations = 0;
  int iterations_max = 0;
  int substeps = 0;
  int handed_back = 0;  ///< solves in which the chosen solver found no root
  int fallbacks = 0;    ///< mid-point sub-steps that the end-point scheme took
  bool converged = true;
  bool is_approximate = false;  ///< contacts were solved by sweeps: see Heap
  bool cut_short = false;       ///< by the settings' most iterations
  double gap = 0;               ///< worst at the end of a step that was cut short or is approximate, m
  double external_work = 0;     ///< of explicit forces, grips and moving targets, J
  double dissipated = 0;        ///< work of dampers, friction, dashpots and impacts, J
  double lost = 0, made = 0;    ///< by the scheme, J: what a (sub-)step leaves unexplained
  double error = 0;             ///< estimated, of positions, in mean lengths of links a second; of mode accurate;
                                ///< infinite: unknown
  double closing_energy = 0;    ///< by moving violated constraints together before the step, J
  double spin_lost = 0;         ///< angular momentum that the points cannot carry after that, kg m^2/s
};

}  // namespace iota::solver
