// SPDX-License-Identifier: Apache-2.0
// g = e_0 . y: an arm stays level.
#pragma once

#include "solver/constraints/arms.h"

namespace iota::solver {

struct LevelConstraint : ArmConstraint<LevelConstraint, 1, 1> {
  double reference = 1;  ///< reference length of violations, m

  double reference_length() const { return reference; }
  void calc_value(const Vec3* e, double /*fraction*/, double* g) const { g[0] = e[0].y; }
  void calc_gradient(const Vec3*, Vec3 (*d)[1]) const { d[0][0] = {0, 1, 0}; }
  void calc_hessian(const Vec3*, const double*, bool, Mat3 (*h)[1]) const { h[0][0] = {}; }
};

}  // namespace iota::solver
