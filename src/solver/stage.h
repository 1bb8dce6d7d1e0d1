// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/settings.h"
#include "solver/sparse/block_factor.h"

#include <limits>

namespace iota::solver {

/// The equations of a Newton solve. With u = x - x0 - h v0:
///   inertia * M u - f(x) + Gh' lambda = 0,   g(x) - compliance * lambda = 0
/// end point (backward Euler): inertia = 1/h^2, Gh = G(x);  mid-point: inertia = 2/h^2, Gh = (G(x0) + G(x)) / 2.
struct Stage {
  double h = 0;  ///< s; 0: a pure projection of positions, without velocities and forces
  double inertia = 1;
  Scheme scheme = Scheme::end_point;
  Storage storage = Storage::symmetric;  ///< of the matrix; the mid-point scheme needs the general one
  double fraction = 1;                   ///< of the step, for targets that move during it
  double fraction_start = 0;             ///< start of this (sub-)step
  double compliance = exact_rows;        ///< relative: multiplies sum |G|^2 / (inertia m) of each row
  double softness = 1e-6;                ///< the same, of places that stick in a projection; see equations_of

  double tolerance = 1e-9;  ///< of the scaled residual; remaining gaps are about this fraction of a link
  int max_iterations = 60;
  int iterations_left = std::numeric_limits<int>::max();  ///< of a budget
  double part = 1;  ///< of the whole step whose row compliance the stage has: a taut net stores energy in it

  /// By more than one pivot, so that no momentum has to be kept: factors of an earlier step leave an error common to all
  /// points, of 1e-5 of the angular momentum of a free body.
  bool is_held = false;
  /// The states of contacts are sought where these are soft: see Integrator::try_step.
  bool begins_softly = false;

  bool is_heap = false;  ///< contacts connect loose bodies in loops, which sweeps move if no solution is found

  bool is_mid_point() const { return scheme == Scheme::mid_point; }
  bool is_projection() const { return h == 0; }
  /// The compliance of a row is this times sum |G|^2 / m.
  double row_compliance() const { return compliance / (inertia * part * part); }
  static Stage end_point(double h, double from, double to) {
    return {.h = h, .inertia = 1 / (h * h), .fraction = to, .fraction_start = from};
  }
  static Stage mid_point(double h, double from, double to) {
    return {.h = h,
            .inertia = 2 / (h * h),
            .scheme = Scheme::mid_point,
            .storage = Storage::general,
            .fraction = to,
            .fraction_start = from,
            .tolerance = 1e-10,
            .max_iterations = 30};
  }
  /// The share of an error of its start that a part of a step leaves, which closes evenly until the end of the step.
  double part_left() const { return (1 - fraction) / (1 - fraction_start); }
  static Stage projection(double compliance = exact_rows) { return {.compliance = compliance}; }
};

}  // namespace iota::solver
