// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace iota::solver {

/// A weighted sum of points equals a target: a nail (one point, weight 1), a point of a rigid body tied to the body's
/// basis (weights 1, -w_1 ... -w_4, target 0), or two coincident such points of different bodies. constraint g(x) =
/// sum_i w_i x_i - t(fraction) (3 rows, m)
///   gradient    dg/dx_i = w_i I;   Hessian zero
/// t moves linearly from target_start to target during the step. The multiplier is minus the force on the sum, N.
struct AffineConstraint {
  static constexpr int rows = 3;
  static constexpr int max_nodes = 8;
  static constexpr bool has_curvature = false;

  std::array<std::uint32_t, max_nodes> nodes{};
  std::array<double, max_nodes> weights{};
  std::uint32_t count = 0;
  Vec3 target_start, target;
  double reference = 1;  ///< reference length of violations, m

  int node_count() const { return static_cast<int>(count); }
  void value(const Vec3* x, double fraction, double* g) const {
    Vec3 sum = -1.0 * (target_start + fraction * (target - target_start));
    for (std::uint32_t i = 0; i < count; ++i) sum += weights[i] * x[nodes[i]];
    g[0] = sum.x, g[1] = sum.y, g[2] = sum.z;
  }
  void gradient(const Vec3*, int i, Vec3* rows_out) const {
    rows_out[0] = {weights[i], 0, 0}, rows_out[1] = {0, weights[i], 0}, rows_out[2] = {0, 0, weights[i]};
  }
  double curvature(const double*, int, int) const { return 0; }
  double reference_length() const { return reference; }
  bool is_nail() const { return count == 1; }
  bool is_moving() const { return target != target_start; }
  bool is_internal() const {
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) sum += weights[i];
    return std::abs(sum) < 1e-9;
  }
  /// See Arms.
  template <class Visit>
  void visit_places(Visit visit) {
    if (is_internal()) return;
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) sum += weights[i];
    visit(target_start, -sum), visit(target, -sum);
  }
};

}  // namespace iota::solver
