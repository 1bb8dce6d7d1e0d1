// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <array>
#include <cstdint>

namespace iota::solver {

/// A constant distance of two points; the row of all rigid bodies.
///   constraint  g(x) = (|d|^2 - L^2) / (2 s),   d = x_b - x_a
///   gradient    dg/dx_b = d / s,  dg/dx_a = -d / s
///   Hessian     (1 / s) [I -I; -I I]: constant, so that the mean of two gradients is a discrete gradient
/// L: wanted length, m; s: scale, m (L itself, or the first length of a closing pair). The multiplier is
/// then the tension in N (times |d|/s). Source: Garcia de Jalon, Twenty-five years of natural coordinates, 2007.
struct DistanceConstraint {
  static constexpr int rows = 1;
  static constexpr int max_nodes = 2;
  static constexpr bool has_curvature = true;

  std::array<std::uint32_t, max_nodes> nodes{};
  double length = 1;
  double scale = 1;

  static constexpr int node_count() { return 2; }
  void value(const Vec3* x, double /*fraction*/, double* g) const {
    const Vec3 d = x[nodes[1]] - x[nodes[0]];
    g[0] = (0.5 * (1 / scale)) * (dot(d, d) - length * length);  // the same division as elsewhere, so it is done once
  }
  /// Gradient with respect to node i, at x, one Vec3 a row.
  void gradient(const Vec3* x, int i, Vec3* rows_out) const {
    const Vec3 along = (1 / scale) * (x[nodes[1]] - x[nodes[0]]);
    rows_out[0] = i == 0 ? -along : along;
  }
  /// Hessian block of multiplier * g between nodes i and j is this times the identity.
  double curvature(const double* multiplier, int i, int j) const {
    return (i == j ? 1 : -1) * (multiplier[0] * (1 / scale));
  }
  double reference_length() const { return scale; }
  /// Whether g is invariant under translations, so that its forces keep momentum.
  static constexpr bool is_internal() { return true; }
  static constexpr bool is_moving() { return false; }
};

}  // namespace iota::solver
