// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

// The limits by which the solver decides, each relative to lengths, masses, energies or times of the problem itself.
// `docs/measurements.md` gives the measurements behind them.

namespace iota::solver {

inline constexpr double closed_gap = 1e-6;  ///< of a reference length: a row with less is met
/// The same after a step of the end-point rule: 100 kg that fall on a taut net of bars of 10 g strain them by 1.5e-6, as their
/// rows are compliant. Rejected, that step was halved to 16 parts, a frame of 50 others. The mid-point rule needs no more.
inline constexpr double strained_gap = 2e-6;
inline constexpr double round_off = 4e-15;  ///< relative, of sums of forces and of rows

/// Relative compliances (Stage::compliance). Rows that no step or projection can meet are tried softer and softer: then
/// conflicting rows share the violation.
inline constexpr std::array row_compliances{1e-12, 1e-9, 1e-6, 1e-3};
inline constexpr double exact_rows = row_compliances.front();

enum class Scheme : std::uint8_t {
  end_point,  ///< backward Euler: v1 = (x1 - x0)/h
  mid_point,  ///< energy-momentum: v1 = 2 (x1 - x0)/h - v0 (Betsch and Leyendecker 2006)
};

/// A way to solve a (sub-)step. One that is rejected is halved, if that may help; the shortest parts go to the next attempt.
struct Attempt {
  Scheme scheme;
  double compliance;  ///< relative
  bool is_halved;
};
/// In this order, from that of the settings' scheme. After the last one the points coast: see Integrator::coast.
inline constexpr std::array attempts{
    Attempt{Scheme::mid_point, exact_rows, true},          Attempt{Scheme::end_point, exact_rows, true},
    Attempt{Scheme::end_point, row_compliances[1], false}, Attempt{Scheme::end_point, row_compliances[2], false},
    Attempt{Scheme::end_point, row_compliances[3], false},
};

/// From plausible to accurate. `docs/solver.md` lists cost and accuracy of each.
struct IntegratorSettings {
  Scheme scheme = Scheme::mid_point;
  double tolerance = 1;   ///< of Newton's method, as a multiple of 1e-9 (end point) and 1e-10 (mid-point)
  double max_turn = 1.1;  ///< rad: a mid-point (sub-)step that turns a link further is halved
  int max_depth = 6;      ///< sub-steps down to a 64th: a whip needs them, for a few steps
  int patience = 400;     ///< Newton iterations after which sub-steps are no longer halved
  double max_error = 0;   ///< estimated, of (sub-)steps, in link lengths per second; 0: no limit

  /// A solve by the end-point rule with contacts has so many: the states of what is not solved by then cycle.
  static constexpr int contact_iterations = 10;
  /// The same by the mid-point rule, of loose bodies that touch in loops, and how often their steps are halved before sweeps move
  /// them. Of 80 steps that were halved more often 7 found a solution; of 540 solves with more iterations 90 did, where
  /// halves take less.
  static constexpr int heap_iterations = 24;
  static constexpr int heap_depth(Scheme scheme) { return scheme == Scheme::mid_point ? 3 : 2; }

  /// Multiplications of all factors of a step of bodies that only contacts connect. What would need more is solved
  /// approximately: see Heap.
  double contact_budget = std::numeric_limits<double>::infinity();
  double contact_share = 1;  ///< of this problem
  bool is_beyond_share(double multiplications) const { return multiplications > contact_share * contact_budget; }
  double part = 1;  ///< of a whole step: sweeps take so many of their sub-steps
  /// Multiplications for a single step, as blows need more than what follows: four budgets, or eight for what sweeps would let go,
  /// twice as many for machines. Few problems need them at the same time, so that each gets more than its share.
  double contact_burst(bool is_tree, bool is_machine = false) const {
    return (is_machine ? 2 : 1) * (is_tree ? 8 : 4) * std::sqrt(contact_share) * contact_budget;
  }
  /// Steps may owe so many bursts beyond what they have by themselves, by which each pays back.
  static constexpr double most_owed = 4;
  /// Multiplications that a step or a part of it has by itself.
  double contact_allowance() const { return part * contact_share * contact_budget; }

  int max_iterations = 0;  ///< of all solves of a step, without the last resort's; 0: unlimited
  /// When all solves of a step have to end, but the last resort's.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

  static constexpr int last_resort_iterations = 24;  ///< beyond `max_iterations`
  static constexpr int last_resort_pieces = 8;       ///< of a (sub-)step
  /// After so many steps without a solution (a box that lies on a plane by one row) most get only so many iterations.
  static constexpr int full_tries = 4, brief_iterations = 24;
  static constexpr double largest_violation = 1e-2;  ///< relative: a step with wider gaps is rejected

  static IntegratorSettings plausible() { return {.scheme = Scheme::end_point, .tolerance = 100, .max_depth = 4}; }
  static IntegratorSettings robust() { return {.scheme = Scheme::end_point}; }
  static IntegratorSettings energy_keeping() { return {}; }
  static IntegratorSettings accurate(double max_error = 1e-4) {
    return {.tolerance = 0.1, .max_turn = 0.35, .max_depth = 10, .patience = 10000, .max_error = max_error};
  }
};

/// Settings of Newton's method. Residuals are scaled to displacements in link lengths.
struct NewtonSettings {
  static constexpr int max_halvings = 12;          ///< of a Newton step
  static constexpr int max_doublings = 12;         ///< of one with a clamped Hessian
  static constexpr double exact_below = 1e-2;      ///< residual below which the exact Hessian is used with any pivots
  static constexpr double fast = 0.5;              ///< convergence; slower steps are checked, and stretched
  static constexpr double round_off_floor = 1e-8;  ///< a residual below it that no step reduces counts as zero
  static constexpr double noise = 10;              ///< times the estimate of round-off: the same
  /// A costly factor is used again after an iteration that reduced the residual to this part; then to the second.
  static constexpr double reuse_after = 0.03, reuse_again = 0.1;
  static constexpr int more_for_sides = 4;      ///< times max_iterations, while bounded rows change sides
  static constexpr int halvings_for_sides = 6;  ///< of a step after which contacts change states

  /// If a solution is sought softly, contacts have so many times their compliance in so many iterations; in the second number
  /// while states change.
  static constexpr double softening = 1e4;
  static constexpr int few_soft = 2, most_soft = 8;
  static constexpr int more_for_cones = 2;  ///< then, times max_iterations, while contacts change states

  static constexpr int polish_steps = 4;
  static constexpr double polish_clean = 3e-13, polish_noise = 1e-12, polish_fast = 0.3;  ///< see Newton::polish
};

}  // namespace iota::solver
