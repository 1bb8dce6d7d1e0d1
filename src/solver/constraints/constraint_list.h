// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/affine.h"
#include "solver/constraints/distance.h"

#include <concepts>
#include <tuple>
#include <vector>

namespace iota::solver {

/// What the solver asks of a constraint: pure mathematics on an array of points.
template <class C>
concept Constraint = requires(const C& c, const Vec3* x, double* g, Vec3* rows, const double* multiplier) {
  { C::rows } -> std::convertible_to<int>;
  { C::max_nodes } -> std::convertible_to<int>;
  { C::has_curvature } -> std::convertible_to<bool>;
  { c.node_count() } -> std::convertible_to<int>;
  c.value(x, 1.0, g);
  c.gradient(x, 0, rows);
  { c.curvature(multiplier, 0, 0) } -> std::convertible_to<double>;
  { c.reference_length() } -> std::convertible_to<double>;
  { c.is_internal() } -> std::convertible_to<bool>;
};

/// The one list of constraint types; pools, sparsity, assembly and reports are folds over it.
template <template <class> class Pool>
using ConstraintPools = std::tuple<Pool<DistanceConstraint>, Pool<AffineConstraint>>;

static_assert(Constraint<DistanceConstraint> && Constraint<AffineConstraint>);

}  // namespace iota::solver
