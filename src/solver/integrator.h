// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/advance_report.h"
#include "solver/energy_balance.h"
#include "solver/heap.h"
#include "solver/holds.h"
#include "solver/judge.h"
#include "solver/local_projection.h"
#include "solver/newton.h"
#include "solver/rigid_motion.h"
#include "solver/runge_kutta.h"
#include "solver/settings.h"
#include "solver/spin.h"
#include "solver/tetrahedra.h"

#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace iota::solver {

/// Advances problems by one step each. One integrator is for one problem structure; it owns the work space, so a warm
/// step allocates nothing.
class Integrator {
 public:
  /// Problems with contacts are analyzed when they are solved, without the order: heaps may never be. order: see Assembly.
  void compile(Problem& problem, const KnownOrder& order = {});
  /// Whether it can follow a change of structure; else the problem is built and compiled again.
  bool can_follow() const { return !is_due_; }
  /// After a change of structure by the problem's own functions: see Problem::open.
  void follow(Problem& problem);
  bool set_slots_of_forces(Problem& problem) const {
    return is_due_ || newton_.set_slots_of_forces(problem);
  }  ///< see Assembly
  void set_slots_of_velocity_forces(Problem& problem) const {
    if (!is_due_) newton_.set_slots_of_velocity_forces(problem);
  }

  /// Advances positions, velocities and multipliers of `problem` by h seconds.
  /// Constraints that are violated at the start are first closed by moving positions only; remaining gaps are held at
  /// their size, so that a conflict adds neither motion nor energy. Then a table of attempts is tried, for the whole step
  /// and for shorter and shorter parts of it: see integrator.cpp. The last one always succeeds.
  AdvanceReport advance(Problem& problem, double h, const IntegratorSettings& settings);

  /// The next `advance` begins as the latest one did, if its caller has restored the state of the problem: what that one
  /// has left here is taken back, and factors are forgotten.
  void take_back() { is_taken_back_ = has_advanced_, newton_.forget_factors(); }

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

  /// The place of a node in the order of elimination of what is compiled.
  std::uint32_t node_rank(std::uint32_t node) const { return is_due_ ? node : newton_.node_rank(node); }
  /// Whether that order takes little more than when it was found, and that work: see KnownOrder. Of an analyzed problem.
  bool is_order_fine() const {
    constexpr double most = 1.5;
    return !is_due_ && newton_.pattern().calc_work() <= most * order_work();
  }
  double order_work() const { return newton_.pattern().usual_work(); }
  double reference_length() const { return reference_length_; }  ///< of what is compiled, m

  /// The solver of the equations of steps; null: the built-in Newton.
  void set_external(Solver* solver) { newton_.set_external(solver); }

  void project_velocities(Problem& problem, double h = 0, std::span<const Vec3> impulses = {}) {
    make_ready(problem);
    newton_.project_velocities(problem, h, impulses);
  }

  /// Whether a projection of all rows takes more than the budget of contacts, so that it leaves these to steps.
  bool is_projected_as_heap(Problem&, const IntegratorSettings&);
  /// Both projections of such a problem, onto its bodies and joints alone: see Heap::project. With targets, of one whose step is left
  /// to sweeps. None if it is no such problem.
  std::optional<bool> project_heap(Problem&, const IntegratorSettings&, const Heap::Projection&);

 private:
  void forget_steps(Problem&);
  AdvanceReport advance_within_limits(Problem&, double h, const IntegratorSettings&);
  /// A part of the step; the whole one is from 0 to 1.
  struct Part {
    double from = 0, to = 1;
    double h = 0;   ///< s
    int depth = 0;  ///< of halving
    std::array<Part, 2> halves() const {
      const double middle = (from + to) / 2;
      return {Part{from, middle, h / 2, depth + 1}, Part{middle, to, h / 2, depth + 1}};
    }
  };
  void make_room(const Problem&);
  void make_ready(Problem&);
  void analyze(Problem&, const KnownOrder& order = {});
  /// Who solves the contacts of a problem.
  enum class Contacts : std::uint8_t {
    exact,    ///< its equations
    machine,  ///< these, but for steps in which they take more than a blow may; then sweeps
    heap,     ///< these within the budget; else sweeps
  };
  Contacts kind_of_contacts(Problem&, const IntegratorSettings&, double& cost);
  bool may_sweep() const { return contacts_ == Contacts::heap; }
  bool is_beyond(Problem&, const IntegratorSettings&, double iterations);
  bool is_beyond_budget(Problem&, double& cost);
  void sweep(Problem&, const Part&, AdvanceReport&);
  /// In mode accurate: a part of the step has no estimate.
  void note_unknown_error(AdvanceReport&) const;
  void damp(Problem&, double time, AdvanceReport&);
  void stay(Problem&, double h, bool is_alone);
  void look_at(Problem&);
  void begin_like_the_latest();
  void note_beginning();
  void find_holds(Problem&, const Vec3* x = nullptr);

  void advance_part(Problem&, const Part&, std::size_t attempt, AdvanceReport&);
  bool may_need_mid_point(Problem&) const;
  bool may_halve(const Part&, const AdvanceReport&) const;
  bool take(Problem&, const Part&, const Attempt&, AdvanceReport&);
  bool is_acceptable(Problem&, const Stage&, Trial, StepEnergy&, AdvanceReport&);
  void commit(Problem&, const Stage&, const StepEnergy&, AdvanceReport&);
  void note_momenta(const Problem&, const Stage&);
  bool restore_momenta(Problem&);
  bool has_taken_off(const StepEnergy&) const;
  void move_rigidly_instead(Problem&, const Part&, AdvanceReport&);
  void coast(Problem&, double h, AdvanceReport&);
  bool coast_a_piece(Problem&, double h, AdvanceReport&);
  bool opens_gaps(const Problem&) const;
  bool pay(Problem&, double energy);
  void act_with_held_forces(Problem&, double h, AdvanceReport&);
  void move_rigidly(Problem&, double h, AdvanceReport&);
  double compliance_part(const Part&, Scheme) const;
  bool will_turn_too_far(const Problem&, double h) const;
  bool turns_too_far(const Problem&) const;
  /// Whether a round thing would be on the other side of what it may touch: its distance is the same there.
  static bool passes_through_round(const Problem&, const Stage&, std::span<const Vec3> after);
  bool mirrors_a_solid(const Problem&, std::span<const Vec3> before, std::span<const Vec3> after);
  static void track(Problem&, double fraction);
  static void add_impulses(Problem&, double h);

  std::span<const double> lumped_masses(const Problem&);
  void make_guess(const Problem&, const Stage&);
  void sweep_lengths(const Problem&, const Stage&);
  bool try_step(Problem&, const Stage&, AdvanceReport&);
  bool solve(Problem&, const Stage&, AdvanceReport&);
  bool solve_jammed_contacts(Problem&, const Stage&, AdvanceReport&);
  bool solve_softer_contacts(Problem&, const Stage&, AdvanceReport&);
  bool is_out_of_budget();

  static void fit_contacts(Problem&, double share);
  bool find_bounces(Problem&, const Part&) const;
  static void forget_bounces(Problem&);
  /// Lets a part of a step leave a part of each overlap that it begins with.
  static void spread_overlaps(Problem&, double from, double left);
  bool has_impacts(const Problem&, const Stage&) const;
  static bool has_driven_rows(const Problem&);
  void solve_impacts(Problem&, const Stage&, const StepEnergy&, AdvanceReport&);
  void project_velocities_after_step(Problem&, const Stage&, AdvanceReport&);
  double note_projection(Problem&, double kinetic, bool drives, AdvanceReport&);
  Spin& spin() {
    if (!spin_) spin_ = std::make_unique<Spin>();
    return *spin_;
  }
  void book_held_forces_that_press(Problem&, const Stage&, AdvanceReport&);
  void give_spin_back(Problem&, const Stage&, double damped, AdvanceReport&);
  void remove_made_energy(Problem&, double energy_before);
  void remove_energy_of_gaps(Problem&, double recoil);
  bool change_kinetic_energy(Problem& problem, double excess) {
    return change_kinetic_energy(problem, excess, rigid_motion(problem));
  }
  bool change_kinetic_energy(Problem&, double excess, const std::optional<RigidMotion>& shared);
  std::optional<RigidMotion> rigid_motion(const Problem&) const;
  bool scale_motion(Problem&, double excess, const std::optional<RigidMotion>& shared);
  double kinetic_energy_of_motion(const Problem&) const;
  bool give_energy_back(Problem&, const Stage&, double taken, AdvanceReport&);
  void give_energy_back_by_piece(Problem&, const Stage&, AdvanceReport&);
  static bool may_turn(const Problem&);
  void turn_body(Problem&, const Stage&, double missing, const RigidMotion&, std::uint32_t piece, AdvanceReport&);
  void find_pieces_if_due(const Problem&);
  void find_holds_of_pieces(const Problem&);
  RigidMotion rigid_motion_of_piece(const Problem&, std::uint32_t piece) const;
  void scale_motions_of_pieces(Problem&, double missing, AdvanceReport&);
  void keep_correction(const Problem&);

  double advance_explicitly(Problem&, double h, AdvanceReport&);
  double take_explicit_steps(Problem&, double h, double start, AdvanceReport&);
  void set_times_of_laws(Problem&, double before, double at_end, AdvanceReport&);
  bool is_accurate(Problem&, const Stage&, AdvanceReport&);
  bool is_smooth(Problem&, double h);
  bool begin_motion(Problem&, bool has_accelerations, AdvanceReport&);
  bool begin_springs(Problem&, double h, AdvanceReport&);
  struct FreeMotion {
    static constexpr std::uint32_t all = UINT32_MAX;
    RigidMotion motion;
    std::uint32_t piece = all;
  };
  void find_free_motions(Problem&);
  void keep_momenta(Problem&, const FreeMotion&, double time) const;
  void keep_energy(Problem&, const RungeKutta&, AdvanceReport&);

  void close_gaps(Problem&, AdvanceReport&);
  void keep_offsets(Problem&, AdvanceReport&);
  void drop_offsets(Problem&);
  bool share_gaps(Problem&, double fraction, AdvanceReport&);
  void close_to_round_off(Problem&);
  bool try_projection(Problem&, int iterations);
  bool project_in_one_solve(Problem&);
  bool close_bit_by_bit(Problem&);

  Newton newton_;
  bool is_due_ = false;  ///< not analyzed yet
  double reference_length_ = 1;
  std::unique_ptr<Heap> heap_;               // if there ever were contacts
  bool is_heap_ = false;                     // see Heap::find_bodies
  bool is_heap_known_ = false;               // since the latest change of structure
  Tetrahedra tetrahedra_;                    // see mirrors_a_solid
  bool knows_tetrahedra_ = false;            // since the latest change of structure
  Contacts contacts_ = Contacts::exact;      // in this step
  std::optional<double> heap_cost_;          // of a factor
  std::unique_ptr<LocalProjection> local_;   // if it was needed
  std::vector<std::uint32_t> center_;        // of the latest
  std::unique_ptr<RungeKutta> runge_kutta_;  // if it was needed
  std::vector<Vec3> saved_position_, saved_velocity_;
  std::vector<double> lumped_mass_;
  std::vector<double> multipliers_saved_;
  std::vector<Vec3> candidate_;  // a solution, while its error is estimated
  std::vector<double> candidate_multipliers_;

  // State of the present step.
  IntegratorSettings settings_;
  double least_turn_cosine_ = std::cos(settings_.max_turn);
  double step_length_ = 0;  ///< s
  EnergyBalance energy_;
  Holds holds_;
  bool has_curved_rows_ = false;      ///< that act, whose energy the mid-point rule does not keep
  bool drives_rows_ = false;          ///< a target moves, or a row has a rate
  bool is_conservative_ = true;       ///< no external work
  std::uint64_t acting_version_ = 0;  ///< of the problem, when these were found
  bool keeps_offsets_ = false;
  int iterations_left_ = std::numeric_limits<int>::max();
  int resort_left_ = 0;  ///< iterations of the last resort beyond a budget
  bool is_cut_short_ = false;
  bool is_over_ = false;        ///< the rest of the step is taken, too
  bool makes_energy_ = false;   ///< the latest solution, and was refused for that
  bool solves_part_ = false;    ///< of the step
  bool is_instant_ = false;     ///< see is_instant
  bool has_corrected_ = false;  ///< velocities after the latest (sub-)step; Newton has the correction
  double violation_ = 0;        ///< relative, left by the latest solve
  int met_ = 0;                 ///< bounded rows that became active in the latest solve

  std::unique_ptr<Spin> spin_;  // if it was needed
  bool may_be_in_pieces_ = false;
  struct Piece {
    Holds holds;
    double taken = 0, kinetic = 0;
  };
  std::vector<Piece> pieces_;  // of a disconnected problem; else none
  Pieces connected_;
  RoomForPieces room_for_pieces_;
  std::vector<FreeMotion> free_motions_;                         // of the explicit sub-step at hand
  ActiveSet::Springs springs_ = ActiveSet::Springs::obey_loads;  // in explicit sub-steps

  // The state with which the latest `advance` began; see take_back.
  bool has_advanced_ = false, is_taken_back_ = false;  // since the last change of structure
  bool may_have_been_in_pieces_ = false;
  std::size_t piece_count_before_ = 0;
  Pieces connected_before_;
};

}  // namespace iota::solver
