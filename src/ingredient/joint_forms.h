// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/coupling_form.h"
#include "ingredient/distance_form.h"
#include "ingredient/path_form.h"
#include "ingredient/pin_form.h"
#include "ingredient/surface_form.h"

#include <cstddef>
#include <tuple>
#include <utility>

namespace iota::ingredient::joint {

/// The list of forms, in the order of their numbers; building, loading, storing and reading joints are folds over it.
using JointForms = std::tuple<PinForm, DistanceForm, PathForm, SurfaceForm, SurfacePairForm, CouplingForm>;

/// visit.operator()<F>() for the form of a kind.
template <std::size_t first = 0, class Visit>
decltype(auto) with_form(ConstraintKind kind, Visit&& visit) {
  using F = std::tuple_element_t<first, JointForms>;
  static_assert(static_cast<std::size_t>(F::form) == first);
  if constexpr (first + 1 == std::tuple_size_v<JointForms>) {
    return visit.template operator()<F>();
  } else {
    if (info(kind).form == F::form) return visit.template operator()<F>();
    return with_form<first + 1>(kind, std::forward<Visit>(visit));
  }
}

/// Passes the rows of a joint, except a coupling's, to sink(row, use).
template <class Sink>
void build_rows(const JointArms& arms, Sink& sink) {
  RowSink<Sink> out(arms.c, sink);
  with_form(arms.c.kind, [&]<class F>() { F::build(arms, out); });
}

/// visit(row): the row of a joint's coordinate, with a target of zero. False if the bodies are too thin for it.
template <class Visit>
bool with_coordinate(const JointArms& arms, JointCoordinate which, Visit visit) {
  return with_form(arms.c.kind, [&]<class F>() { return F::with_coordinate(arms, which, visit); });
}

/// Brings a row that holds, and its multipliers, to the state of its joint.
template <class Row>
void load_hold(Row& row, const Model& model, const Constraint& c, RowUse use, double* multipliers) {
  std::copy_n(c.multipliers.begin() + use.first, Row::rows, multipliers);
  with_form(c.kind, [&]<class F>() { F::load(row, model, c, multipliers); });
}
template <class Row>
void store_hold(const Row& row, Constraint& c, RowUse use, const double* multipliers) {
  std::copy_n(multipliers, Row::rows, c.multipliers.begin() + use.first);
  with_form(c.kind, [&]<class F>() { F::store(row, c, multipliers); });
}

}  // namespace iota::ingredient::joint
