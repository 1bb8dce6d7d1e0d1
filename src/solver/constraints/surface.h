// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/surface.h"
#include "solver/constraints/place.h"

namespace iota::solver {

/// A point on a surface fixed in a body or in the world, or, with a one-sided multiplier, on one side of it.
///   constraint  g(x) = phi(xi)   (m);   gradient and Hessian: those of phi through xi (see place.h)
/// Inside: multiplier >= 0; outside: <= 0. The multiplier is the normal force over |grad phi|, N, pulling inwards.
struct SurfaceConstraint : PlaceConstraint<SurfaceConstraint, 1> {
  const shape::Surface* surface = nullptr;

  double reference_length() const { return surface->scale(); }
  void calc_place_value(const Vec3& xi, double /*fraction*/, double* g) const { g[0] = surface->at(xi).value; }
  void calc_place_gradient(const Vec3& xi, Vec3* d) const { d[0] = surface->at(xi).gradient; }
  Mat3 calc_place_hessian(const Vec3& xi, const double* lambda) const { return lambda[0] * surface->at(xi).hessian; }
};

}  // namespace iota::solver
