// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/affine.h"
#include "solver/constraints/angle.h"
#include "solver/constraints/bilinear.h"
#include "solver/constraints/cone.h"
#include "solver/constraints/contact.h"
#include "solver/constraints/coupling.h"
#include "solver/constraints/curve.h"
#include "solver/constraints/distance.h"
#include "solver/constraints/friction_line.h"
#include "solver/constraints/resistance.h"
#include "solver/constraints/span.h"
#include "solver/constraints/surface.h"
#include "solver/constraints/surface_pair.h"

#include <concepts>
#include <tuple>
#include <type_traits>
#include <vector>

namespace iota::solver {

/// The interface of a constraint for the solver: pure mathematics on an array of points.
template <class C>
concept Constraint = requires(const C& c, const Vec3* x, double* g) {
  { C::rows } -> std::convertible_to<int>;
  { C::max_nodes } -> std::convertible_to<int>;
  { C::has_curvature } -> std::convertible_to<bool>;
  { c.node_count() } -> std::convertible_to<int>;
  c.value(x, 1.0, g);
  { c.reference_length() } -> std::convertible_to<double>;
  { c.is_internal() } -> std::convertible_to<bool>;  ///< g is invariant under translations
  { c.is_moving() } -> std::convertible_to<bool>;    ///< g depends on time during the step
};

/// Gradients are given by node and Hessian blocks are multiples of the identity: the rows of bodies.
template <class C>
concept SimpleConstraint = Constraint<C> && requires(const C& c, const Vec3* x, Vec3* rows, const double* multiplier) {
  c.gradient(x, 0, rows);
  { c.curvature(multiplier, 0, 0) } -> std::convertible_to<double>;
};

/// Gradients are given for all nodes and Hessian blocks are full matrices: see ArmConstraint.
template <class C>
concept GeneralConstraint = Constraint<C> && requires(const C& c, const Vec3* x, Vec3* rows) {
  c.gradients(x, 1.0, rows);
  { c.first_side } -> std::convertible_to<std::uint32_t>;
};

/// Stores its present place, to stay on the same branch: `track` after each (sub-)step.
template <class C>
concept TrackingConstraint = requires(C& c, const Vec3* x) { c.track(x, 1.0); };

/// Three rows whose bounds depend on each other's multipliers: pure mathematics on a state that the solver keeps. Values
/// along tangents are slips, measured from the start of the (sub-)step. The first row is a reaction, the last one is along
/// a tangent. See ConeState, ConeEquations.
template <class C>
concept ConeConstraint = GeneralConstraint<C> && C::rows == 3 && C::is_tangent(2) && !C::is_tangent(0) &&
                         requires(const C& c, ConeState state, const double* multipliers, const double* g) {
                           { C::is_one_sided(0) } -> std::same_as<bool>;  ///< g >= 0, its multiplier is never positive
                           { c.compliance_of(0) } -> std::same_as<double>;
                           { c.state_of(multipliers) } -> std::same_as<ConeState>;
                           { c.switch_state(state, multipliers, g, g, 1.0) } -> std::same_as<ConeState>;
                           { c.equations(state, multipliers, g, g) } -> std::same_as<ConeEquations>;
                         };

/// A cone that knows impacts: its reaction leaves it with a speed, see Newton::solve_impacts.
template <class C>
concept BouncingConstraint = ConeConstraint<C> && requires(C& c) { c.restitution, c.meets, c.rebound, c.drags; };

/// The energy that the compliance of a cone's rows stores, J.
template <ConeConstraint C>
double strain_energy(const C& c, const double* multipliers) {
  double energy = 0;
  if constexpr (requires { c.is_strained; })
    if (!c.is_strained) return 0;
  for (int r = 0; r < C::rows; ++r) energy += 0.5 * c.compliance_of(r) * multipliers[r] * multipliers[r];
  return energy;
}

/// Gradients by arms, of which those of the nodes are multiples: see ContactConstraint.
template <class C>
concept SharedGradientConstraint = GeneralConstraint<C> && requires { typename C::ByArms; };

/// Values and gradients of a constraint at x, gradients node by node. Those of the general ones and of distances are evaluated
/// before the visits: otherwise the compiler must assume that the caller's writes change their inputs.
template <class C>
class Gradients {
  static constexpr bool all_at_once = GeneralConstraint<C> || C::max_nodes <= 2;

 public:
  Gradients(const C& c, const Vec3* x, double fraction) : constraint_(c), x_(x), fraction_(fraction) {
    if constexpr (GeneralConstraint<C>)
      c.gradients(x, fraction, rows_.data());
    else if constexpr (all_at_once)
      for (int i = 0; i < C::max_nodes; ++i) c.gradient(x, i, rows_.data() + i * C::rows);
  }
  void value(double* g) const { constraint_.value(x_, fraction_, g); }
  const Vec3* places() const { return x_; }
  double fraction() const { return fraction_; }
  void of_node(int i, Vec3* out) const {
    if constexpr (all_at_once)
      for (int r = 0; r < C::rows; ++r) out[r] = rows_[i * C::rows + r];
    else
      constraint_.gradient(x_, i, out);
  }

 private:
  const C& constraint_;
  const Vec3* x_;
  double fraction_;
  std::array<Vec3, all_at_once ? C::max_nodes * C::rows : 0> rows_;
};

template <SharedGradientConstraint C>
class Gradients<C> {
 public:
  Gradients(const C& c, const Vec3* x, double fraction)
      : constraint_(c), fraction_(fraction), arms_(c.arms(x, fraction)), by_arms_(c.by_arms(arms_)) {}
  void value(double* g) const { constraint_.calc_value(arms_.data(), fraction_, g); }
  void of_node(int i, Vec3* out) const { constraint_.gradient(by_arms_, i, out); }
  const auto& arms() const { return arms_; }

 private:
  const C& constraint_;
  double fraction_;
  std::array<Vec3, C::arm_count> arms_;
  typename C::ByArms by_arms_;
};

/// Has its own discrete gradient for the mid-point scheme, as the mean of the gradients at both ends of a step does not
/// give its change exactly.
template <class C>
concept DiscreteGradientConstraint =
    GeneralConstraint<C> && requires(const C& c, const Vec3* x, Vec3* rows) { c.mean_gradients(x, 0.0, x, 1.0, rows); };

/// The gradients of the mid-point scheme: the mean over a step from x0 to where `at_end` is.
template <class C>
class MeanGradients {
 public:
  MeanGradients(const C& c, const Vec3* x0, double start, const Gradients<C>& at_end) : at_start_(c, x0, start) {
    if constexpr (DiscreteGradientConstraint<C>)
      c.mean_gradients(x0, start, at_end.places(), at_end.fraction(), rows_.data());
  }
  /// at_end: the gradients of the node at the end of the step.
  void of_node(int i, const Vec3* at_end, Vec3* out) const {
    if constexpr (DiscreteGradientConstraint<C>) {
      for (int r = 0; r < C::rows; ++r) out[r] = rows_[i * C::rows + r];
    } else {
      at_start_.of_node(i, out);
      for (int r = 0; r < C::rows; ++r) out[r] = 0.5 * (out[r] + at_end[r]);
    }
  }

 private:
  struct Unused {
    Unused(const C&, const Vec3*, double) {}
  };
  std::conditional_t<DiscreteGradientConstraint<C>, Unused, Gradients<C>> at_start_;
  std::array<Vec3, DiscreteGradientConstraint<C> ? C::max_nodes * C::rows : 0> rows_;
};

template <SharedGradientConstraint C>
class MeanGradients<C> {
 public:
  MeanGradients(const C& c, const Vec3* x0, double start, const Gradients<C>& at_end)
      : constraint_(c), by_arms_(c.mean_by_arms(c.arms(x0, start), at_end.arms())) {}
  void of_node(int i, const Vec3* /*at_end*/, Vec3* out) const { constraint_.gradient(by_arms_, i, out); }

 private:
  const C& constraint_;
  typename C::ByArms by_arms_;
};

/// The list of constraint types; pools, sparsity, assembly and reports are folds over it.
template <template <class> class Pool>
using ConstraintPools =
    std::tuple<Pool<DistanceConstraint>, Pool<AffineConstraint>, Pool<BilinearConstraint>, Pool<AngleConstraint>,
               Pool<CurveConstraint>, Pool<StationConstraint>, Pool<SurfaceConstraint>, Pool<SurfacePairConstraint>,
               Pool<SpanConstraint>, Pool<CouplingConstraint>, Pool<FrictionLineConstraint>, Pool<ContactConstraint>,
               Pool<ResistanceConstraint>>;

/// Rows where bodies touch, which end when they part.
template <class C>
constexpr bool is_of_contact = std::is_same_v<C, ContactConstraint> || std::is_same_v<C, ResistanceConstraint>;

template <class C>
struct CheckConstraint {
  static_assert(SimpleConstraint<C> || GeneralConstraint<C>);
};
static_assert(sizeof(ConstraintPools<CheckConstraint>) > 0);

}  // namespace iota::solver
