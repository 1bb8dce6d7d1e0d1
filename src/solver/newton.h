// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"
#include "solver/sparse/block_factor.h"

#include <span>
#include <vector>

namespace iota {
class Solver;
}

namespace iota::solver {

/// Which equations a Newton solve closes. With u = x - x0 - h v0:
///   inertia * M u - f(x) + Gh' lambda = 0,   g(x) - compliance * lambda = 0
/// end point (backward Euler): inertia = 1/h^2, Gh = G(x);  mid-point: inertia = 2/h^2, Gh = (G(x0) + G(x)) / 2.
struct Stage {
  double h = 0;  ///< s; 0: a pure projection of positions, without velocities and forces
  double inertia = 1;
  bool midpoint = false;
  double fraction = 1;        ///< of the step, for targets that move during it
  double fraction_start = 0;  ///< where this (sub-)step begins
  double compliance = 1e-12;  ///< relative: multiplies sum |G|^2 / (inertia m) of each row

  double tolerance = 1e-9;  ///< of the scaled residual; gaps end at about this fraction of a link
  int max_iterations = 60;

  bool is_projection() const { return h == 0; }
  static Stage end_point(double h, double from, double to) {
    return {.h = h, .inertia = 1 / (h * h), .fraction = to, .fraction_start = from};
  }
  static Stage mid_point(double h, double from, double to) {
    return {.h = h,
            .inertia = 2 / (h * h),
            .midpoint = true,
            .fraction = to,
            .fraction_start = from,
            .tolerance = 1e-10,
            .max_iterations = 30};
  }
  static Stage projection(double compliance = 1e-12) { return {.compliance = compliance}; }
};

struct [[nodiscard]] NewtonReport {
  bool converged = false;
  int iterations = 0;
  bool handed_back = false;  ///< another solver was asked and found no root
  int met = 0;  ///< bounded rows that came from a bound to their equation: impacts, friction that begins to stick
  double residual = 0;  ///< scaled, dimensionless
  double violation =
      0;  ///< of the constraints alone, as a fraction of their reference lengths: compliance lets conflicting
          ///< ones "converge" without being met
};

/// Newton's method with exact geometric stiffness, globalised: a step is taken when the scaled residual or an l1 merit
/// falls; the Hessian is clamped to positive semi-definite once full steps stop halving the residual or a pivot has the
/// wrong sign. `docs/solver.md` gives the measurements behind each rule.
///
/// Rows with bounds (RowLaw): primal-dual active set (Hintermueller, Ito, Kunisch 2002). At each iteration a row is at the
/// bound beyond which lambda + g / (natural compliance) lies, or free; at a bound it keeps its place in the matrix, as
/// an identity. All rows change at once while that lessens how many are wrong, else one at a time, lowest first, which
/// cannot cycle (Judice and Pires 1994).
class Newton {
 public:
  /// Analyses the structure of the problem; call again whenever nodes, constraints or forces were added or removed.
  void compile(Problem& problem);
  /// Does as `compile` after nodes were added at the end and rows between them rewired, for a fraction of the time where
  /// that is possible. `added`: the new nodes and an old neighbour in the order each; `removed`: nodes that nothing
  /// refers to any more, which go; `touched`: all nodes that gained or lost a coupling, those included.
  void relink(Problem& problem, std::span<const std::array<std::uint32_t, 2>> added,
              std::span<const std::uint32_t> removed, std::span<const std::uint32_t> touched);

  /// Solves for positions and multipliers, from `guess`, a displacement from free flight x0 + h v0, and the pools' multipliers. On success `solution()` and the
  /// pools' multipliers are the answer; on failure both hold the best iterate. The problem's own state is not touched.
  NewtonReport solve(Problem& problem, const Stage& stage, std::span<const Vec3> guess);
  std::span<const Vec3> solution() const { return x_; }
  /// Where the next solution will be: scratch until then.
  std::span<Vec3> room() { return x_; }
  /// Of the solution: x - x0 - h v0, m. The unknown itself, to its own relative precision: velocities taken from it keep
  /// momentum to round-off, whereas differences of positions lose 1e-16 |x| / h a step.
  std::span<const Vec3> displacement() const { return u_; }

  /// Hands the equations of steps, not of projections, to another solver; null: solves them itself. What the other one
  /// finds no root of is solved here after all.
  void set_external(Solver* solver) { external_ = solver; }

  /// The velocity nearest to `velocity` in the mass norm with G(position) v = rate, in place; rate is that of targets and
  /// lengths that move during the next h seconds (h = 0: nothing moves). Keeps momentum and angular momentum, except what
  /// nails take. Of bounded rows those count that are met and would take an impulse; `as_solved`: those that the latest
  /// solve left free.
  /// `impulses`: of each node, if any, that act at the same time, N s.
  void project_velocities(Problem& problem, double h, bool as_solved = false, std::span<const Vec3> impulses = {});

  double reference_length() const { return reference_length_; }  ///< mean of the constraints', m

 private:
  friend class StepEquations;
  bool try_relink(Problem&, std::span<const std::array<std::uint32_t, 2>> added, std::span<const std::uint32_t> removed,
                  std::span<const std::uint32_t> touched);
  template <class C>
  void set_slots(ConstraintPool<C>&, std::size_t item, const BlockPattern::ConstraintSlot&) const;
  template <class F>
  void set_slots(ForcePool<F>&, std::size_t item) const;
  void set_node_places(const Problem&);
  enum class Hessian { exact, clamped, none };
  template <bool Midpoint>
  NewtonReport solve_as(Problem&, const Stage&);
  NewtonReport solve_externally(Problem&, const Stage&);
  template <bool Midpoint>
  double residual(const Problem&, const Stage&, const Vec3* x);
  template <bool Midpoint, bool Laws, class C>
  void add_rows(const Problem&, const Stage&, const ConstraintPool<C>&, const Vec3* x);
  template <bool Midpoint, bool Laws, class C>
  void assemble_rows(const Problem&, const Stage&, const ConstraintPool<C>&, Hessian);
  void begin_sides(Problem&, const Stage&);
  bool choose_sides(Problem&, const Stage&);
  int count_met(const Problem&) const;
  void begin_impulse_sides(Problem&, bool as_solved);
  bool release_impulses(Problem&);
  void add_to_node(std::uint32_t node, double value);
  template <bool Midpoint>
  void add_to_pair(const BlockPattern::PairSlot&, double value);
  template <bool Midpoint, class C>
  void add_curvature(const C&, const typename ConstraintPool<C>::Slots&, const Stage&, const double* lambda,
                     bool clamp);
  template <bool Midpoint>
  void assemble(const Problem&, const Stage&, Hessian);
  template <bool Midpoint>
  int assemble_and_factor(const Problem& problem, const Stage& stage, Hessian hessian) {
    assemble<Midpoint>(problem, stage, hessian);
    return factor_.factorise();
  }
  double merit(const Problem&, const Stage&, const Vec3* x) const;
  bool project_onto_sides(Problem&, double h, bool as_solved, std::span<const Vec3> impulses);
  void project_once(Problem&, double h, std::span<const Vec3> impulses);
  /// Takes a residual that is within tolerance to round-off; returns what it is then.
  template <bool Midpoint>
  double polish(Problem&, const Stage&, NewtonReport&, bool factor_is_old);
  void solve_linear();
  void save(const Problem&);
  /// u + t du and lambda + t d_lambda, from the saved iterate.
  void move(Problem&, const Stage&, double t);

  BlockPattern pattern_;
  BlockFactor factor_;
  std::vector<std::uint32_t> node_unknown_, node_diagonal_;
  std::vector<std::uint8_t> node_stride_;
  std::vector<Vec3> x_, x_saved_, u_, u_saved_, momentum_;
  std::vector<double> residual_, step_, impulses_, multipliers_saved_, merit_weights_;
  std::vector<double> inverse_scale_;  // of the force residual of each node
  double reference_length_ = 1;
  // Found by the latest residual(); imbalance_: of the scaled forces, and noise_: what of it is round-off.
  double worst_ = 0, violation_ = 0, imbalance_ = 0, noise_ = 0, largest_multiplier_ = 0;
  bool has_laws_ = false;
  Solver* external_ = nullptr;
  int fewest_wrong_ = 0, stalled_ = 0;  // see choose_sides
};

}  // namespace iota::solver
