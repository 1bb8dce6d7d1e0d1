// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/newton.h"

#include <iota/solver.h>

namespace iota::solver {

/// The equations that `Newton` closes in a (sub-)step, for any other solver: its own residual and its own matrix, written
/// out dense, with unknowns and equations scaled to be about 1. Displacements from free flight in mean constraint lengths, multipliers in what
/// moves a mean mass by such a length in a step; residuals as Newton measures them. Bounded rows stay on their sides.
class StepEquations final : public NonlinearProblem {
 public:
  StepEquations(Newton&, Problem&, const Stage&);

  std::size_t size() const override { return row_scale_.size(); }
  void evaluate(std::span<const double> x, std::span<double> f) override;
  bool jacobian(std::span<const double> x, std::span<double> jacobian) override;

  /// Newton's iterate and the pools' multipliers, scaled.
  std::vector<double> unknowns() const;
  /// Sets Newton's iterate and the pools' multipliers; returns the residual in Newton's scaling.
  double assign(std::span<const double> unknowns);

 private:
  template <class Visit>  // visit(unknown, multiplier, is at a constant bound)
  void for_each_row(Visit visit) const;

  Newton& newton_;
  Problem& problem_;
  const Stage& stage_;
  std::vector<double> row_scale_, column_scale_;
};

}  // namespace iota::solver
