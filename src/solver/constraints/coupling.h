// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/angle.h"
#include "solver/constraints/bilinear.h"
#include "solver/constraints/curve.h"
#include "solver/constraints/span.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

namespace iota::solver {

/// A weighted sum of coordinates equals a target: gears, belts (two angles), rack and pinion, screw (an angle and a
/// slide), differential (three angles), or, with a one-sided multiplier, a rope over several points (lengths).
///   constraint  g(x) = sum_k r_k q_k(x) - target(fraction);   q_k: a row of one coordinate, whose own target is zero
///   gradient    sum_k r_k grad q_k;   Hessian sum_k r_k Hess q_k
/// The multiplier times r_k is the torque or force (N m, N) that pulls coordinate k down. In the mid-point scheme each
/// coordinate has a discrete gradient, so that the coupling transmits all work at any ratios.
struct CouplingConstraint {
  static constexpr int rows = 1;
  static constexpr int max_nodes = 32;
  static constexpr int max_term_nodes = 8;
  static constexpr bool has_curvature = true;

  using Coordinate = std::variant<AngleConstraint, BilinearConstraint, SpanConstraint, StationConstraint>;
  struct Term {
    double ratio = 1;
    Coordinate coordinate;  ///< its nodes are indices of `nodes`
  };
  std::array<std::uint32_t, max_nodes> nodes{};  ///< distinct
  std::uint32_t count = 0;
  std::uint32_t first_side = 0;  ///< see Arms; the gradient by these nodes does not vanish
  std::vector<Term> terms;
  double target_start = 0, target = 0;
  double reference = 0;  ///< the largest of the terms, in the unit of g

  /// False, without a change, if there is no room.
  bool list_node(std::uint32_t node) {
    if (std::find(nodes.begin(), nodes.begin() + count, node) != nodes.begin() + count) return true;
    if (count == max_nodes) return false;
    nodes[count++] = node;
    return true;
  }
  /// All nodes of the row must be listed already.
  template <class Row>
  void add(double ratio, Row row) {
    for (std::uint32_t i = 0; i < row.count; ++i)
      row.nodes[i] =
          static_cast<std::uint32_t>(std::find(nodes.begin(), nodes.begin() + count, row.nodes[i]) - nodes.begin());
    terms.push_back({ratio, row});
    reference = std::max(reference, std::abs(ratio) * row.reference_length());
  }

  int node_count() const { return static_cast<int>(count); }
  double reference_length() const { return reference; }
  bool is_internal() const {
    return std::all_of(terms.begin(), terms.end(), [](const Term& term) {
      return std::visit([](const auto& row) { return row.is_internal(); }, term.coordinate);
    });
  }
  /// See Arms.
  template <class Visit>
  void visit_places(Visit visit) {
    for (Term& term : terms) std::visit([&](auto& row) { row.visit_places(visit); }, term.coordinate);
  }
  bool is_moving() const {
    return target != target_start || std::any_of(terms.begin(), terms.end(), [](const Term& term) {
             return std::visit([](const auto& row) { return row.is_moving(); }, term.coordinate);
           });
  }
  void track(const Vec3* x, double fraction) {
    const Points own(*this, x);
    for (Term& term : terms)
      std::visit(
          [&](auto& row) {
            if constexpr (requires { row.track(x, fraction); }) row.track(own.x, fraction);
          },
          term.coordinate);
  }

  void value(const Vec3* x, double fraction, double* g) const {
    const Points own(*this, x);
    g[0] = -(target_start + fraction * (target - target_start));
    for_each_row([&](const Term& term, const auto& row) {
      double q = 0;
      row.value(own.x, fraction, &q);
      g[0] += term.ratio * q;
    });
  }
  void gradients(const Vec3* x, double fraction, Vec3* out) const {
    const Points own(*this, x);
    sum_up(out, [&](const auto& row, Vec3* rows) { row.gradients(own.x, fraction, rows); });
  }
  void mean_gradients(const Vec3* x0, double start, const Vec3* x1, double end, Vec3* out) const {
    const Points own0(*this, x0), own1(*this, x1);
    sum_up(out, [&](const auto& row, Vec3* rows) {
      if constexpr (requires { row.mean_gradients(x0, start, x1, end, rows); }) {
        row.mean_gradients(own0.x, start, own1.x, end, rows);
      } else {
        Vec3 at_start[max_term_nodes];
        row.gradients(own0.x, start, at_start), row.gradients(own1.x, end, rows);
        for (std::uint32_t i = 0; i < row.count; ++i) rows[i] = 0.5 * (at_start[i] + rows[i]);
      }
    });
  }
  void curvature(const Vec3* x, double fraction, const double* lambda, bool clamp, Mat3* blocks) const {
    const Points own(*this, x);
    std::fill_n(blocks, count * (count + 1) / 2, Mat3{});
    for_each_row([&](const Term& term, const auto& row) {
      Mat3 of_row[max_term_nodes * (max_term_nodes + 1) / 2];
      const double share = term.ratio * lambda[0];
      row.curvature(own.x, fraction, &share, clamp, of_row);
      const Mat3* block = of_row;
      for (std::uint32_t a = 0; a < row.count; ++a)
        for (std::uint32_t b = a; b < row.count; ++b, ++block) {
          const std::uint32_t i = row.nodes[a], j = row.nodes[b];
          blocks[index_of_block(std::min(i, j), std::max(i, j))] += i <= j ? *block : block->transposed();
        }
    });
  }

 private:
  /// The points by their indices in `nodes`.
  struct Points {
    Vec3 x[max_nodes];
    Points(const CouplingConstraint& c, const Vec3* all) {
      for (std::uint32_t i = 0; i < c.count; ++i) x[i] = all[c.nodes[i]];
    }
  };
  /// Blocks of the upper triangle, row by row.
  std::uint32_t index_of_block(std::uint32_t i, std::uint32_t j) const { return i * count - i * (i + 1) / 2 + j; }

  template <class Visit>
  void for_each_row(Visit visit) const {
    for (const Term& term : terms) std::visit([&](const auto& row) { visit(term, row); }, term.coordinate);
  }
  template <class Gradients>
  void sum_up(Vec3* out, Gradients gradients) const {
    std::fill_n(out, count, Vec3{});
    for_each_row([&](const Term& term, const auto& row) {
      Vec3 rows[max_term_nodes];
      gradients(row, rows);
      for (std::uint32_t i = 0; i < row.count; ++i) out[row.nodes[i]] += term.ratio * rows[i];
    });
  }
};

}  // namespace iota::solver
