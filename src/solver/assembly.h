// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/node_vectors.h"
#include "solver/problem.h"
#include "solver/sparse/block_factor.h"
#include "solver/stage.h"
#include "solver/timed.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace iota::solver {

/// Elastic energy of compliant rows, J.
struct Strain {
  double released = 0;   ///< by the compliance of this (sub-)step
  double of_stored = 0;  ///< and by what they had stored
  double of_joints = 0;  ///< of `released`, by all rows but those of contacts
};
/// Mean length of the bodies' rods, m; joints and curves have their own lengths. Without rods, of the forces between
/// points; else 1 m. Sets it for rows of nails and of carried points, which have no other.
double set_reference_lengths(Problem&);

/// Residuals of the equations of a step; all scaled, dimensionless.
struct Residual {
  double worst = 0;      ///< of all equations, without forces that are round-off
  double rows = 0;       ///< of the constraints' equations
  double violation = 0;  ///< of the constraints alone, as a fraction of their reference lengths: compliance lets
                         ///< conflicting ones "converge" without being met
  double imbalance = 0;  ///< of the forces
  double noise = 0;      ///< part of the imbalance that is round-off
};

/// Constraint curvature and force stiffness: exact; made positive semi-definite (tension only); or left out.
enum class Hessian { exact, clamped, none };

/// The equations of a step (Stage) for one problem: their residual, their matrix and its factors. Has the place of each
/// node, row and coupling in the matrix.
class Assembly {
 public:
  /// Analyzes the structure of the problem; call again after nodes, constraints or forces were added or removed ...
  /// Returns whether it was like the latest one, whose slots in the matrix are then kept. order: of the nodes;
  /// empty: it is found.
  bool compile(Problem&, const KnownOrder& order = {});
  /// ... or, if they were added and removed by the problem's own functions, follow the change: removes marked nodes and
  /// finds new slots near the changes, in a fraction of the time.
  void follow(Problem&);
  /// Gives slots to the forces that have none. False, without a change, if one couples points that were not coupled.
  bool set_slots_of_forces(Problem&) const;
  /// Forces that are loaded anew for each step. Each is on points of one body, which are coupled.
  void set_slots_of_velocity_forces(Problem&) const;
  /// From now on adds the times of forces, factors and solutions to `times`; null: they are not measured.
  void add_times_to(StepTimes* times) { times_ = times; }

  /// At positions x = x0 + h v0 + u and the pools' multipliers; by unknown in `residuals()`.
  Residual residual(const Problem&, const Stage&, const Vec3* x, const Vec3* u);
  /// Whether every unbalanced force in that residual is round-off of the forces of stiff laws, that is, at most their
  /// stiffness times the round-off of the places.
  bool is_round_off_of_laws(const Problem&, const Stage&, const Vec3* x);
  /// Whether rows may hold the same, by the latest factors and residual. So it also seems where rows are eliminated before one of
  /// the bodies that they hold, as in a chain of hinges.
  bool may_have_redundant_rows() const { return redundancy_ > 0.05; }
  /// Whether residuals find that out. They need not where rows form no loops: it takes a fifteenth of the sum of rows.
  void look_for_redundant_rows(bool look) { looks_for_redundant_rows_ = look; }
  /// Loads what takes out of the multipliers by how much rows press against each other: see Newton::find_shares. False if
  /// they are strained by more than round-off.
  bool load_redundant_shares(const Problem&, const Stage&, const Vec3* x);
  /// The elastic energy that compliant rows have released on the way to a solution at x. They had stored what the multipliers
  /// before this (sub-)step, N, have done on the gaps that it starts from, however long the steps then were.
  Strain strain_released(const Problem&, const Stage&, const Vec3* x, std::span<const double> multipliers_before) const;
  /// Loads the residual of M a + G' lambda = f, G a + v' G' v = 0 at a = 0, lambda = 0, at the problem's positions and
  /// velocities. Their solution is minus the step of a projection's matrix, without Hessian. Rows at a bound are left out.
  void load_rates(const Problem&);
  /// The derivative of the residual, in the storage of the stage.
  void assemble(const Problem&, const Stage&, const Vec3* x, Hessian);
  /// Converts residuals to the Newton step, matrix^-1 residuals, to be subtracted: with the latest factors ...
  void solve() {
    const Timed timed(times_, &StepTimes::solve);
    factor_.solve(unknowns_);
  }
  /// ... or with new ones. False if the signs of pivots are not those of a constrained minimum.
  bool factor_and_solve(const Problem&, const Stage&, const Vec3* x, Hessian);

  std::size_t unknown_count() const { return unknowns_.size(); }
  std::uint32_t unknown_of(std::uint32_t node) const { return node_unknown_[node]; }
  std::span<double> residuals() { return unknowns_; }
  std::span<const double> step() const { return unknowns_; }
  Vec3 step_of(std::uint32_t node) const {
    const double* const d = unknowns_.data() + node_unknown_[node];
    return {d[0], d[1], d[2]};
  }
  /// N; `residuals()` become the step in place.
  NodeVectors residuals_of_nodes() const { return {unknowns_.data(), node_unknown_.data()}; }
  double reference_length() const { return reference_length_; }  ///< mean of the constraints', m
  /// Forces are scaled to the displacement of a point in a step, in mean constraint lengths.
  double inverse_scale(const Stage& stage) const { return 1 / (stage.inertia * reference_length_); }  ///< times mass
  /// Whether the latest factors are those of a matrix of this stage, maybe of an earlier step with other places. Not after
  /// a change of structure.
  bool has_factors_of(const Stage&) const;
  void forget_factors() { factored_.reset(); }
  /// Whether a factorization costs much more than the rest of an iteration.
  bool is_dear() const { return factor_.is_dear(); }
  const BlockPattern& pattern() const { return *pattern_; }
  BlockFactor& factor() { return factor_; }

 private:
  template <class C>
  void set_slots(ConstraintPool<C>&, std::size_t item, std::uint32_t unknown) const;
  template <class F>
  void set_slots(ForcePool<F>&, std::size_t item) const;
  template <class IsDue>
  void set_slots_of_items(Problem&, IsDue);
  void set_slots_of_nodes(const Problem&);
  BlockPattern& own_pattern() {
    if (!own_pattern_) own_pattern_ = std::make_shared<BlockPattern>();
    return *own_pattern_;
  }
  void weigh(const Problem&);
  bool has_extreme_masses() const { return row_compliance_ < 1; }
  /// With extreme masses a sub-step has its own compliance: at that of the whole step, tensions would open joints.
  double row_compliance(const Stage& stage) const {
    return row_compliance_ * (has_extreme_masses() ? stage.compliance / stage.inertia : stage.row_compliance());
  }

  void add_momentum(const Problem&, const Stage&, const Vec3* x, const Vec3* u);
  template <Scheme S, bool Laws, class C>
  void add_rows(const Problem&, const Stage&, const ConstraintPool<C>&, const Vec3* x);
  template <Scheme S, class C>
  void add_resistance(const Stage&, const ConstraintPool<C>&, const Vec3* x0, const Vec3* x);

  template <class C>
  void load_row_forces(const Problem&, const ConstraintPool<C>&, std::size_t item, double* row);
  void add_force(std::uint32_t node, const Vec3& force) {
    double* const r = unknowns_.data() + node_unknown_[node];
    r[0] += force.x, r[1] += force.y, r[2] += force.z;
  }
  void add_torque(const BodyTorque& t, const BodyTorque::Forces& forces) {
    for (std::uint32_t i = 0; i < t.count; ++i) add_force(t.nodes[i], -forces[i]);
  }
  void add_to_node(std::uint32_t node, double value);
  template <Storage T>
  void add_to_pair(const BlockPattern::PairSlot&, double value);
  /// For rows whose curvature is a multiple of the identity for each pair of nodes.
  template <Storage T, class C, class Between>
  void add_isotropic_curvature(const C&, const typename ConstraintPool<C>::Slots&, Between);
  template <Storage T, class C>
  void add_curvature(const C&, const typename ConstraintPool<C>::Slots&, const Stage&, const Vec3* x,
                     const double* lambda, bool clamp);
  template <Scheme S, Storage T>
  void assemble_all(const Problem&, const Stage&, const Vec3* x, Hessian);
  template <Scheme S, Storage T, bool Laws, class C>
  void assemble_rows(const Problem&, const Stage&, const ConstraintPool<C>&, const Vec3* x, Hessian);
  template <Storage T, class F>
  void assemble_forces(const Problem&, const ForceStage&, const ForcePool<F>&, const Vec3* x);

  StepTimes* times_ = nullptr;
  std::shared_ptr<const BlockPattern> pattern_;  // its own, or one that small problems share: see PatternCache
  std::shared_ptr<BlockPattern> own_pattern_;    // with room for the next one; null if there never was one
  std::uint64_t structure_ = 0;                  // of the problem when it was compiled: see Problem::structure
  BlockFactor factor_;
  std::vector<std::uint32_t> node_unknown_, node_diagonal_;
  std::vector<std::uint8_t> node_stride_;
  std::vector<double> unknowns_;   // residuals, and then the step
  std::optional<Stage> factored_;  // of the latest factors
  double reference_length_ = 1;
  /// Only for extreme masses: of each node its mass plus the equivalent mass of its rows, kg.
  std::vector<double> resistance_;
  std::vector<double> blur_;   ///< of each node: round-off of the laws' forces, N; only if Newton's method stalls
  double row_compliance_ = 1;  ///< a factor of the stage's, below 1 for extreme masses
  double worst_ = 0, violation_ = 0, largest_multiplier_ = 0;  // of the rows, during the sum of a residual
  /// The largest compliance of a row in parts of its pivot: near 1 if others hold the same, else near 0.
  double redundancy_ = 0;
  bool looks_for_redundant_rows_ = true;
};

}  // namespace iota::solver
