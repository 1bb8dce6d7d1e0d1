// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/advance_report.h"
#include "solver/holds.h"
#include "solver/local_projection.h"
#include "solver/newton.h"
#include "solver/rigid_motion.h"
#include "solver/runge_kutta.h"
#include "solver/spin.h"

#include <chrono>
#include <memory>

namespace iota::solver {

enum class Scheme : std::uint8_t {
  end_point,  ///< backward Euler: v1 = (x1 - x0)/h
  mid_point,  ///< energy-momentum: v1 = 2 (x1 - x0)/h - v0 (Betsch and Leyendecker 2006)
};

/// Settings from plausible to accurate. `docs/solver.md` lists cost and accuracy of each.
struct Care {
  Scheme scheme = Scheme::mid_point;
  double tolerance = 1;  ///< of Newton's method, as a multiple of 1e-9 (end point) and 1e-10 (mid-point)
  double max_turn = 1.1, max_turn_cosine = 0.4536;  ///< rad: a mid-point (sub-)step that turns a link further is halved
  int max_depth = 6;                                ///< sub-steps down to a 64th: a whip needs them, for a few steps
  int patience = 400;                               ///< Newton iterations after which sub-steps are no longer halved
  int max_iterations = 0;  ///< of all solves of a step, without the last resort's; 0: unlimited
  /// When all solves of a step have to end, but the last resort's.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  double max_error = 0;  ///< estimated, of (sub-)steps, in link lengths per second; 0: no limit

  static Care plausible() { return {.scheme = Scheme::end_point, .tolerance = 100, .max_depth = 4}; }
  static Care robust() { return {.scheme = Scheme::end_point}; }
  static Care energy_keeping() { return {}; }
  static Care accurate(double max_error = 1e-4) {
    return {.tolerance = 0.1,
            .max_turn = 0.35,
            .max_turn_cosine = 0.9394,
            .max_depth = 10,
            .patience = 10000,
            .max_error = max_error};
  }
};

/// Advances problems by one step each. One integrator is for one problem structure; it owns the work space, so a warm
/// step allocates nothing.
class Integrator {
 public:
  void compile(Problem& problem);
  /// After a change of structure by the problem's own functions: see Problem::open.
  void follow(Problem& problem);
  bool place_forces(Problem& problem) const { return newton_.place_forces(problem); }  ///< see Assembly

  /// Advances positions, velocities and multipliers of `problem` by h seconds.
  /// mid_point halves the step (to a 64th) when a link turns too far in it, its error is too large or Newton fails, and
  /// then falls back to end_point, for that sub-step only. end_point never gains energy without external work.
  /// Constraints that are violated at the start are first closed by moving positions only; remaining gaps are held at
  /// their size, so that a conflict adds neither motion nor energy.
  AdvanceReport advance(Problem& problem, double h, const Care& care);

  /// Moves positions by the least mass-weighted displacement that meets all constraints; velocities stay.
  /// Returns false if no solution was found: the violation is then distributed, and smaller after each call.
  bool project_positions(Problem& problem);

  /// Does both only around some points and violated rows, in less time. False if the whole problem must be projected:
  /// see LocalProjection. Positions only on request.
  bool project_locally(Problem& problem, bool positions, std::span<const std::uint32_t> nodes = {});
  /// The points that `project_locally` may have moved.
  std::span<const std::uint32_t> moved_locally() const { return local_->nodes(); }

  /// The correction of velocities at the end of the latest step to satisfy the rows, m/s; empty: none.
  std::span<const Vec3> velocity_corrections() const {
    return has_corrected_ ? newton_.velocities_before() : std::span<const Vec3>{};
  }

  /// Whether the end of the step is a state of the equations of motion at that instant, and not of means over it.
  bool is_instant() const { return is_instant_; }
  /// The velocity from which the acceleration of a node there would lead to its velocity there, m/s.
  Vec3 instant_start(std::size_t node, double h) const {
    return runge_kutta_->velocities()[node] - h * runge_kutta_->accelerations()[node];
  }

  double reference_length() const { return newton_.reference_length(); }  ///< of what is compiled, m

  /// The solver of the equations of steps; null: the built-in Newton.
  void set_external(Solver* solver) { newton_.set_external(solver); }

  void project_velocities(Problem& problem, double h = 0, std::span<const Vec3> impulses = {}) {
    newton_.project_velocities(problem, h, impulses);
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
  void measure_kinetic_energy(const Problem&);
  void project_velocities_after_step(Problem&, const Stage&, bool met, AdvanceReport&);
  double work_of_drives(const Problem&, const Stage&) const;
  /// Energy dissipated by laws in a solved step, J.
  struct Dissipation {
    double steady = 0;  ///< work of dampers, dashpots and friction
    double impact = 0;  ///< upper bound for rows that have just become active
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
  double compliance_part(double from, double to) const;
  void advance_mid_point(Problem&, double h, double from, double to, int depth, AdvanceReport&);
  void advance_end_point(Problem&, double h, double from, double to, int depth, AdvanceReport&);
  bool will_turn_too_far(const Problem&, double h) const;
  bool turns_too_far(const Problem&) const;
  bool gains_energy_on_curves(const Problem&, const Stage&);
  double calc_energy_gain(const Problem&, const Stage&);
  void change_kinetic_energy(Problem& problem, double excess) {
    change_kinetic_energy(problem, excess, rigid_motion(problem));
  }
  void change_kinetic_energy(Problem&, double excess, const std::optional<RigidMotion>& shared);
  std::optional<RigidMotion> rigid_motion(const Problem&) const;
  bool scale_motion(Problem&, double excess, const std::optional<RigidMotion>& shared);
  bool give_energy_back(Problem&, const Stage&, double taken, AdvanceReport&);
  void give_energy_back_by_piece(Problem&);
  void give_spin_back(Problem&, const Stage&);
  void keep_correction(const Problem&);
  void find_pieces(const Problem&);
  bool is_accurate(Problem&, const Stage&, AdvanceReport&);
  bool is_smooth(Problem&, double h) const;
  static bool has_closed_row(const Problem&);
  double advance_explicitly(Problem&, double h, AdvanceReport&);
  void keep_momenta(Problem&, const RigidMotion& start, double time) const;
  void keep_energy(Problem&, const RungeKutta&, AdvanceReport&);
  static void track(Problem&, double fraction);
  void hold_offsets(Problem&, AdvanceReport&);
  void restore_bounds(Problem&);
  bool share_gaps(Problem&, double fraction, AdvanceReport&);
  bool is_out_of_budget();
  void keep_start(const Problem&);
  bool least_violation(Problem&, Stage, AdvanceReport&);
  void last_resort_step(Problem&, double h, AdvanceReport&);
  template <class Attempt>
  bool close_bit_by_bit(Problem&, Attempt);
  void close_gaps(Problem&, AdvanceReport&);

  Newton newton_;
  std::unique_ptr<LocalProjection> local_;   // if it was needed
  std::vector<std::uint32_t> center_;        // of the latest
  std::unique_ptr<RungeKutta> runge_kutta_;  // if it was needed
  Care care_;
  std::vector<Vec3> start_position_, start_velocity_;
  std::vector<Vec3> candidate_;  // only for error estimates and the last resort
  std::vector<double> lumped_mass_;
  std::vector<double> multipliers_saved_, candidate_multipliers_;
  double step_length_ = 0;           ///< of the whole step, s
  double kinetic_ = 0, energy_ = 0;  ///< of the problem's present state, J
  double missing_ = 0, slack_ = 0;   ///< unexplained energy of the (sub-)step; surplus within its tolerance, J
  bool has_curved_rows_ = false;     ///< whose energy the mid-point rule does not keep
  bool drives_rows_ = false;         ///< a target moves during this step, or a row has a rate
  bool conservative_ = true;         ///< no external work during this step
  bool holds_offsets_ = false;
  int iterations_left_ = std::numeric_limits<int>::max();
  int resort_left_ = 0;  ///< iterations of the last resort beyond a budget
  bool cut_short_ = false;
  bool is_instant_ = false;     ///< see is_instant
  bool has_corrected_ = false;  ///< velocities after the latest (sub-)step; Newton has the correction
  Holds holds_;
  Spin spin_;
  bool is_free_body_ = false;  ///< one rigid thing that nothing holds
  bool may_be_in_pieces_ = false;
  struct Piece {
    std::uint32_t first;  ///< node
    Holds holds;
    double taken = 0, kinetic = 0;
  };
  std::vector<Piece> pieces_;            // of a disconnected problem; else none
  std::vector<std::uint32_t> piece_of_;  // of each node
  bool keeps_start_ = false;
  double violation_ = 0;  ///< relative, left by the latest solve
  int met_ = 0;           ///< bounded rows that became active in the latest solve
};

}  // namespace iota::solver
