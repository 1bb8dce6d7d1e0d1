// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace iota::solver {

/// A few vectors that are affine in at most eight points, e_a = sum_i w_ai x_i + c_a: an axis, direction or place fixed
/// in a body (by the body's basis) or, without points, in the world. Constants move linearly during the step.
template <int Count>
struct Arms {
  static constexpr int arm_count = Count;
  static constexpr int max_nodes = 8;

  std::array<std::uint32_t, max_nodes> nodes{};  ///< distinct
  std::array<std::array<double, max_nodes>, Count> weights{};
  std::array<Vec3, Count> constant_start{}, constant{};
  std::uint32_t count = 0;
  /// The nodes [0, first_side) belong to one of two bodies, the others to the second; the elimination then puts the
  /// rows behind the body that is eliminated first, so that a hub with many joints stays O(n). 0: one group.
  std::uint32_t first_side = 0;

  /// Adds weight * x_node to an arm. Returns false, and changes nothing, if a ninth point would be needed.
  bool add(int arm, std::uint32_t node, double weight) {
    const auto end = nodes.begin() + count;
    const auto at = static_cast<std::uint32_t>(std::find(nodes.begin(), end, node) - nodes.begin());
    if (at == max_nodes) return false;
    if (at == count) nodes[count++] = node;
    weights[arm][at] += weight;
    return true;
  }
  void set_constant(int arm, const Vec3& c) { constant_start[arm] = constant[arm] = c; }

  int node_count() const { return static_cast<int>(count); }
  Vec3 arm(int a, const Vec3* x, double fraction) const {
    Vec3 e = constant_start[a] + fraction * (constant[a] - constant_start[a]);
    for (std::uint32_t i = 0; i < count; ++i) e += weights[a][i] * x[nodes[i]];
    return e;
  }
  /// All of them.
  std::array<Vec3, Count> arms(const Vec3* x, double fraction) const {
    std::array<Vec3, Count> e;
    for (std::size_t a = 0; a < Count; ++a) e[a] = constant_start[a] + fraction * (constant[a] - constant_start[a]);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 place = x[nodes[i]];
      for (std::size_t a = 0; a < Count; ++a) e[a] += weights[a][i] * place;
    }
    return e;
  }
  /// Whether all arms are differences of points, so that forces on them keep momentum.
  bool is_internal() const {
    return std::all_of(weights.begin(), weights.end(), [this](const auto& w) {
      double sum = 0, size = 0;
      for (std::uint32_t i = 0; i < count; ++i) sum += w[i], size += std::abs(w[i]);
      return std::abs(sum) <= 1e-9 * size;
    });
  }
  bool is_moving() const { return constant != constant_start; }
  /// visit(constant, weight): the constants that are places in the world; the weight is that of a place in the arm.
  template <class Visit>
  void visit_places(Visit visit) {
    for (int a = 0; a < Count; ++a) {
      double sum = 0, size = 0;
      for (std::uint32_t i = 0; i < count; ++i) sum += weights[a][i], size += std::abs(weights[a][i]);
      if (std::abs(sum) > 1e-9 * size) visit(constant_start[a], sum), visit(constant[a], sum);
    }
  }
};

/// Constraints that are functions of a few arms: g_r(e_0, e_1, ...). `Derived` has
///   void calc_value(const Vec3* e, double fraction, double* g) const
///   void calc_gradient(const Vec3* e, Vec3 (*d)[Count]) const                  d[r][a] = dg_r / de_a
///   void calc_hessian(const Vec3* e, const double* lambda, bool clamp, Mat3 (*h)[Count]) const
///                                                                              h[a][b] = sum_r lambda_r d2g_r / de_a de_b, a <= b
/// and the chain rule to the points is here. `clamp`: keep the positive semi-definite part.
template <class Derived, int Rows, int Count>
struct ArmConstraint : Arms<Count> {
  static constexpr int rows = Rows;
  static constexpr bool has_curvature = true;
  using Arms<Count>::max_nodes;

  void value(const Vec3* x, double fraction, double* g) const {
    derived().calc_value(this->arms(x, fraction).data(), fraction, g);
  }
  /// out[i * Rows + r] = dg_r / dx of node i.
  void gradients(const Vec3* x, double fraction, Vec3* out) const {
    Vec3 d[Rows][Count];
    derived().calc_gradient(this->arms(x, fraction).data(), d);
    to_nodes(d, out);
  }
  /// Blocks of sum_r lambda_r Hess(g_r) for the pairs of nodes (i, j), i <= j, row by row.
  void curvature(const Vec3* x, double fraction, const double* lambda, bool clamp, Mat3* blocks) const {
    Mat3 h[Count][Count];
    derived().calc_hessian(this->arms(x, fraction).data(), lambda, clamp, h);
    for (std::uint32_t i = 0; i < this->count; ++i)
      for (std::uint32_t j = i; j < this->count; ++j, ++blocks) {
        *blocks = {};
        for (int a = 0; a < Count; ++a)
          for (int b = 0; b < Count; ++b) {
            const double w = this->weights[a][i] * this->weights[b][j];
            if (w != 0) *blocks += w * (a <= b ? h[a][b] : h[b][a].transposed());
          }
      }
  }

 protected:
  using AllArms = std::array<Vec3, Count>;
  static AllArms mean_of(const AllArms& start, const AllArms& end) {
    AllArms mean;
    for (std::size_t a = 0; a < Count; ++a) mean[a] = 0.5 * (start[a] + end[a]);
    return mean;
  }
  /// From gradients by the arms.
  void to_nodes(const Vec3 (*d)[Count], Vec3* out) const {
    for (std::uint32_t i = 0; i < this->count; ++i)
      for (int r = 0; r < Rows; ++r) {
        Vec3 sum;
        for (int a = 0; a < Count; ++a) sum += this->weights[a][i] * d[r][a];
        out[i * Rows + r] = sum;
      }
  }

 private:
  const Derived& derived() const { return static_cast<const Derived&>(*this); }
};

}  // namespace iota::solver
