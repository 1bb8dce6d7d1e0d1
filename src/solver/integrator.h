// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/local_projection.h"
#include "solver/newton.h"

#include <memory>

namespace iota::solver {

enum class Scheme : std::uint8_t {
  end_point,  ///< backward Euler: v1 = (x1 - x0)/h
  mid_point,  ///< energy-momentum: v1 = 2 (x1 - x0)/h - v0 (Betsch and Leyendecker 2006)
};

/// How carefully to step: the dial from plausible to accurate. `docs/solver.md` has what each setting costs and is worth.
struct Care {
  Scheme scheme = Scheme::mid_point;
  double tolerance = 1;  ///< of Newton's method, as a multiple of the usual 1e-9 (end point) and 1e-10 (mid-point)
  double max_turn = 1.1, max_turn_cosine = 0.4536;  ///< rad: a mid-point (sub-)step that turns a link further is halved
  int max_depth = 6;                                ///< sub-steps down to a 64th: a whip needs them, for a few steps
  int patience = 400;                               ///< Newton iterations after which sub-steps are no longer halved
  int max_iterations = 0;  ///< of all solves of a step, but for the last resort's; 0: unlimited
  double max_error = 0;    ///< estimated, of mid-point (sub-)steps, in link lengths per second; 0: not asked

  static Care plausible() { return {.scheme = Scheme::end_point, .tolerance = 100, .max_depth = 4}; }
  static Care robust() { return {.scheme = Scheme::end_point}; }
  static Care energy_keeping() { return {}; }
  static Care accurate() {
    return {.tolerance = 0.1,
            .max_turn = 0.35,
            .max_turn_cosine = 0.9394,
            .max_depth = 10,
            .patience = 10000,
            .max_error = 1e-4};
  }
};

/// What one problem went through in one step.
struct [[nodiscard]] AdvanceReport {
  int solves = 0;
  int iterations = 0;
  int iterations_max = 0;
  int substeps = 0;
  int handed_back = 0;  ///< solves in which the solver that was asked found no root
  int fallbacks = 0;    ///< mid-point sub-steps that had to be taken by the end-point scheme
  bool converged = true;
  bool cut_short = false;     ///< by the settings' most iterations
  double gap = 0;             ///< worst at the end of a step that was cut short, m
  double external_work = 0;   ///< of explicit forces, grips and moving targets, J
  double dissipated = 0;      ///< by dampers, friction, dashpots and impacts: their own work, J
  double lost = 0, made = 0;  ///< by the scheme, J: what a (sub-)step leaves unexplained
  double closing_energy = 0;  ///< by moving violated constraints together before the step, J
};

/// Advances problems by one step each. One integrator serves one problem structure; it owns the work space, so a warm
/// step allocates nothing.
class Integrator {
 public:
  void compile(Problem& problem);
  /// After a change of structure by the problem's own functions: see Problem::open.
  void follow(Problem& problem);
  bool place_forces(Problem& problem) const { return newton_.place_forces(problem); }  ///< see Assembly

  /// Positions, velocities and multipliers of `problem` become those after h seconds.
  /// mid_point halves the step (to a 64th) when a link turns too far in it, its error is too large or Newton fails, and
  /// then falls back to end_point, for that sub-step only. end_point never ends with more energy than it began with,
  /// unless something outside does work. Constraints that are violated at the start are first closed by moving
  /// positions only; what cannot be closed is held as it is, so that a conflict neither shakes nor heats the world.
  AdvanceReport advance(Problem& problem, double h, const Care& care);

  /// Moves positions by the least mass-weighted displacement that meets all constraints; velocities stay.
  /// Returns false where no solution was found: the violation is then shared, and smaller after each call.
  bool project_positions(Problem& problem);

  /// Does both around some points, and around rows that are open, for less time and for no other row than those. False
  /// where it has to be done in the whole problem: see LocalProjection. Positions only where asked to.
  bool project_locally(Problem& problem, bool positions, std::span<const std::uint32_t> nodes = {});
  /// The points that `project_locally` may have moved.
  std::span<const std::uint32_t> moved_locally() const { return local_->nodes(); }

  double reference_length() const { return newton_.reference_length(); }  ///< of what is compiled, m

  /// Who solves the equations of steps; null: the built-in Newton.
  void set_external(Solver* solver) { newton_.set_external(solver); }

  void project_velocities(Problem& problem, double h = 0, std::span<const Vec3> impulses = {}) {
    newton_.project_velocities(problem, h, false, impulses);
  }

 private:
  void make_room(const Problem&);
  std::span<const double> lumped_masses(const Problem&);
  void make_guess(const Problem&, const Stage&);
  void sweep_lengths(const Problem&, const Stage&);
  bool try_step(Problem&, const Stage&, AdvanceReport&);
  bool solve(Problem&, const Stage&, AdvanceReport&);
  void commit(Problem&, const Stage&, AdvanceReport&);
  void measure_energy(const Problem&, double fraction);
  void project_velocities_after_impact(Problem&, double to, bool met, AdvanceReport&);
  double work_of_drives(const Problem&, const Stage&) const;
  /// What laws take from the motion in a solved step, J.
  struct Dissipation {
    double steady = 0;  ///< by dampers, dashpots and friction: their own work
    double impact = 0;  ///< by rows that have just met; at most
  };
  Dissipation calc_dissipation(const Problem&, const Stage&) const;
  template <class C>
  void add_dissipation_of_rows(const Problem&, const Stage&, const ConstraintPool<C>&, Dissipation&) const;
  void book_solution(const Problem&, const Stage&, double gain);
  void book_rest(const Problem&, double h, AdvanceReport&);
  double work_of_gaps(const Problem&, const Stage&) const;
  double work_of_imbalance(const Problem&, const Stage&) const;
  Vec3 velocity_after(const Problem& problem, const Stage& stage, std::size_t node) const {
    return problem.velocity[node] + ((stage.midpoint ? 2 : 1) / stage.h) * newton_.displacement()[node];
  }
  void advance_mid_point(Problem&, double h, double from, double to, int depth, AdvanceReport&);
  void advance_end_point(Problem&, double h, double from, double to, int depth, AdvanceReport&);
  bool will_turn_too_far(const Problem&, double h) const;
  bool turns_too_far(const Problem&) const;
  void smooth_multipliers(Problem&) const;
  bool gains_energy_on_curves(const Problem&, const Stage&);
  double calc_energy_gain(const Problem&, const Stage&);
  void change_kinetic_energy(Problem&, double excess, double fraction);
  void correct_energy(Problem&, double fraction);
  bool is_accurate(Problem&, const Stage&, AdvanceReport&);
  void hold_offsets(Problem&, AdvanceReport&);
  void restore_bounds(Problem&);
  bool share_gaps(Problem&, double fraction, AdvanceReport&);
  void keep_start(const Problem&);
  bool least_violation(Problem&, Stage, AdvanceReport&);
  void last_resort_step(Problem&, double h, AdvanceReport&);
  template <class Attempt>
  bool close_bit_by_bit(Problem&, Attempt);
  void close_gaps(Problem&, AdvanceReport&);

  Newton newton_;
  std::unique_ptr<LocalProjection> local_;  // where it was needed
  std::vector<std::uint32_t> center_;       // of the latest
  Care care_;
  std::vector<Vec3> start_position_, start_velocity_;
  std::vector<Vec3> candidate_;  // only where errors are estimated, or nothing else helps
  std::vector<double> lumped_mass_;
  std::vector<double> multipliers_saved_, candidate_multipliers_;
  double step_length_ = 0;           ///< of the whole step, s
  double kinetic_ = 0, energy_ = 0;  ///< of the problem's state as it is now, J
  double missing_ = 0, slack_ = 0;  ///< energy that the (sub-)step leaves unexplained; too much within its tolerance, J
  bool has_curved_rows_ = false;    ///< which the mid-point rule does not keep the energy of
  bool drives_rows_ = false;        ///< a target moves during this step, or a row has a rate
  bool conservative_ = true;        ///< nothing outside does work during this step
  bool holds_offsets_ = false;
  int iterations_left_ = std::numeric_limits<int>::max();
  bool cut_short_ = false;
  bool keeps_start_ = false;
  double violation_ = 0;  ///< relative, left by the latest solve
  int met_ = 0;           ///< bounded rows that met in the latest solve
};

}  // namespace iota::solver
