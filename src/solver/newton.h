// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/active_set.h"
#include "solver/assembly.h"

#include <optional>
#include <span>
#include <vector>

namespace iota {
class Solver;
}

namespace iota::solver {

struct [[nodiscard]] NewtonReport {
  bool converged = false;
  int iterations = 0;
  bool handed_back = false;  ///< another solver found no root
  int met = 0;               ///< bounded rows that became equations: impacts, friction that begins to stick
  double residual = 0;       ///< scaled, dimensionless
  double violation =
      0;  ///< of the constraints alone, as a fraction of their reference lengths: compliance lets conflicting
          ///< ones "converge" without being met
};

/// Newton's method with exact geometric stiffness, globalized: a step is taken when the scaled residual or an l1 merit
/// falls; the Hessian is clamped to positive semi-definite once full steps stop halving the residual or a pivot has the
/// wrong sign. `docs/measurements.md` gives the numbers behind each rule. Between iterations an ActiveSet moves bounded
/// rows; at a bound a row keeps its place in the matrix, as an identity.
class Newton {
 public:
  /// Allocates and analyzes the structure of the problem, or follows it: see Assembly.
  bool compile(Problem& problem, const KnownOrder& order = {});
  void follow(Problem& problem);
  bool set_slots_of_forces(Problem& problem) const { return assembly_.set_slots_of_forces(problem); }  ///< see Assembly
  void set_slots_of_velocity_forces(Problem& problem) const { assembly_.set_slots_of_velocity_forces(problem); }
  void add_times_to(StepTimes* times) { assembly_.add_times_to(times); }  ///< see Assembly

  /// Solves for positions and multipliers, from `displacement()` and the pools' multipliers. On success `solution()` and
  /// the pools' multipliers are the answer; on failure both hold the best iterate. The problem's own state stays.
  NewtonReport solve(Problem& problem, const Stage& stage);
  std::span<const Vec3> solution() const { return x_; }
  /// The forces that the latest solution leaves in the equation of each node, N.
  NodeVectors unbalanced_forces() const { return assembly_.residuals_of_nodes(); }
  /// After a step: takes out of the multipliers how much rows that hold the same press against each other.
  void share_among_redundant(Problem&);
  /// See Assembly.
  Strain strain_released(const Problem& problem, const Stage& stage, std::span<const double> multipliers_before) const {
    return assembly_.strain_released(problem, stage, x_.data(), multipliers_before);
  }
  /// The array of the next solution: scratch until then.
  std::span<Vec3> room() { return x_; }
  /// From free flight: x - x0 - h v0, m. This is the unknown itself with its own relative precision: velocities
  /// calculated from it keep momentum to round-off, whereas differences of positions lose 1e-16 |x| / h a step.
  std::span<Vec3> displacement() { return u_; }
  std::span<const Vec3> displacement() const { return u_; }

  /// Passes the equations of steps, not of projections, to another solver; null: solves them itself. If the other one
  /// finds no root, they are solved here.
  void set_external(Solver* solver) { external_ = solver; }
  bool has_external() const { return external_ != nullptr; }
  /// The next step does not begin with the factors of the last one: it depends on nothing but the problem's state.
  void forget_factors() { assembly_.forget_factors(); }
  std::uint32_t node_rank(std::uint32_t node) const { return pattern().node_rank(node); }
  const BlockPattern& pattern() const { return assembly_.pattern(); }

  /// The velocity nearest to `velocity` in the mass norm with G(position) v = rate, in place; rate is that of targets and
  /// lengths that move during the next h seconds (h = 0: nothing moves). Keeps momentum and angular momentum, except what
  /// nails take. Only those bounded rows count that are active and would take an impulse.
  /// `impulses`: simultaneous impulses of each node, if any, N s.
  void project_velocities(Problem& problem, double h, std::span<const Vec3> impulses = {});
  /// State of a problem after a (sub-)step.
  struct AfterStep {
    double kinetic = 0;        ///< energy, J
    bool drives_rows = false;  ///< rows have moving targets
    bool is_isolated = false;  ///< nothing connects it to the world
  };
  /// The same after a committed (sub-)step, with its sides of bounded rows. Drives and couplings get their average
  /// rate: a rotation by an angle a in a step has the velocity 2 tan(a/2) / h in the mid-point rule, and a projection
  /// on a / h would brake a fast wheel at every step. Returns the kinetic energy afterwards; nothing if velocities have
  /// not changed, as they satisfied the rows already or cannot.
  std::optional<double> project_velocities_after(Problem& problem, const Stage& stage, const AfterStep& known);
  /// The same after a (sub-)step with impacts that have a restitution, by at most some kinetic energy: each contact that met
  /// gets the normal speed e times that of its approach, with friction; none pulls. See integrator_impacts.cpp.
  std::optional<double> solve_impacts(Problem& problem, const Stage& stage, const AfterStep& known, double most);
  /// Before the latest projection.
  std::span<Vec3> velocities_before() { return u_saved_; }
  std::span<const Vec3> velocities_before() const { return u_saved_; }

  /// The change of velocities by impulses on the nodes, kg m/s, which rows that are equations resist, and the least one besides, in
  /// the mass norm, that removes the given rates (of the rows, in the order of the pools). Either may be empty. Targets are as at
  /// `fraction` of the step.
  void find_velocity_change(const Problem& problem, std::span<const Vec3> impulses, std::span<const double> rates,
                            double fraction, std::span<Vec3> change);

  /// The accelerations of all nodes, and the pools' multipliers, at the problem's positions and velocities. Rows at a bound
  /// push with their multipliers, compliant ones with their force.
  void find_accelerations(Problem& problem, std::span<Vec3> accelerations);
  /// Moves the problem's positions and velocities, which nearly satisfy the constraints, by the least changes in the
  /// mass norm onto them. False if gaps of more than 1e-10 of a length remain. `time`: since the start of rows with a hold.
  bool project_state(Problem& problem, double time);

  double reference_length() const { return assembly_.reference_length(); }  ///< mean of the constraints', m

 private:
  friend class StepEquations;
  NewtonReport solve_directly(Problem&, const Stage&);
  NewtonReport solve_externally(Problem&, const Stage&);
  void make_room(const Problem&);
  /// x from u.
  void place(const Problem&, const Stage&);
  void measure(const Problem&, const Stage&);
  bool find_step(const Problem&, const Stage&, Hessian);
  /// Returns whether any row changed its side. Halves the latest step where they leave `limit` or more.
  bool choose_sides(Problem&, const Stage&, double limit);
  int stretch(Problem&, const Stage&, double before, bool is_clamped);
  double merit(const Problem&, const Stage&, const Vec3* x) const;
  bool is_balanced() const;
  /// Factor of round-off for links far from the origin; at least 1.
  double blur_of_places(const Problem& problem) const;
  void find_shares(Problem&, const Stage&);
  /// Reduces a residual within tolerance to round-off.
  void polish(Problem&, const Stage&, NewtonReport&, bool factor_is_old);
  void take_step(Problem&, const Stage&);
  void scale_step(Problem&, const Stage&, double factor);
  void take_back_step(Problem&, const Stage&);

  /// The velocities wanted from a projection.
  struct Wanted {
    double h = 0;                    ///< targets move during the next h seconds
    std::span<const Vec3> impulses;  ///< of each node, if any
    bool is_after_step = false, has_impacts = false;
    double still = 0;  ///< m/s: slower rates are round-off of places, so that what rests needs no projection
    double end = 1;    ///< of the (sub-)step, as a fraction of the step
    double tolerance() const { return is_after_step ? 1e-12 : 2e-15; }  ///< of the largest velocity
    double fraction() const { return is_after_step ? 1 : 0; }           ///< of the step, for targets that move
  };
  Wanted begin_after_step(Problem&, const Stage&, const AfterStep&);
  std::optional<double> project_onto_sides(Problem&, const Wanted&, double energy);
  std::optional<double> project_within_cones(Problem&, const Wanted&, double h, double energy);
  static void forget_drags(Problem&);
  double find_rebounds(Problem&, const Stage&, const Wanted&);
  void take_turns(Problem&, const Wanted&, double least);
  std::optional<double> take_turn(Problem&, const Wanted&, double kinetic);
  double rate_in_the_middle(const ContactConstraint&, std::span<const Vec3> velocity) const;
  void give_back_momenta(Problem&) const;
  double find_rates(const Problem&, const Wanted&);
  void set_residuals(std::span<const Vec3> impulses);
  double find_gaps(const Problem&, double time);
  template <class C>
  void add_mean_rates(const C&, double* row) const;
  void add_step_to_velocities(Problem&);
  void give_back_momentum(Problem&, std::span<const Vec3> impulses) const;
  void add_impulses(Problem&) const;
  void note_late_impulses(Problem&, double h) const;

  Assembly assembly_;
  ActiveSet active_set_;
  Residual residual_;                  // of the iterate
  std::vector<Vec3> x_, u_, u_saved_;  // saved: at the start of the latest step, as its multipliers
  std::vector<double> impulses_, multipliers_saved_, merit_weights_;
  std::vector<double> shares_;  // changes of multipliers after the latest solve, or none
  std::vector<Vec3> mean_place_,
      mean_velocity_;  // over the last step; only if rows keep their rates
  struct Turn {
    std::size_t contact = 0;
    ConeState state;  // by the step
    bool acts = false, has_acted = false;
  };
  std::vector<Turn> turns_;                      // of impacts,
  std::vector<Vec3> after_step_, end_of_step_;   // velocities and places, meanwhile
  bool has_laws_ = false, has_stepped_ = false;  // in the latest solve
  std::optional<bool> has_loops_;                // if it was asked
  Solver* external_ = nullptr;
};

}  // namespace iota::solver
