// SPDX-License-Identifier: Apache-2.0
// A matrix in the block pattern and its dense twin, and graphs to make them from.
#pragma once

#include "solver/sparse/block_factor.h"
#include "solver/sparse/block_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

namespace iota::solver {

using Edge = std::array<std::uint32_t, 2>;

/// A matrix with the structure [A G'; G -C] in two forms: in the block pattern, and dense in the pattern's unknowns.
struct Twin {
  BlockPattern pattern;
  BlockFactor factor;
  std::vector<std::vector<double>> dense;
  std::vector<double> right_side;

  Twin(CouplingGraph graph, bool symmetric, std::mt19937& random) {
    pattern.analyze(graph);
    fill(graph, symmetric, random);
  }
  Twin(const BlockPattern& given, const CouplingGraph& graph, bool symmetric, std::mt19937& random) : pattern(given) {
    fill(graph, symmetric, random);
  }

  void fill(const CouplingGraph& graph, bool symmetric, std::mt19937& random) {
    std::uniform_real_distribution<double> number(-1, 1);
    factor.reset(pattern);
    factor.clear(symmetric ? Storage::symmetric : Storage::general);
    const std::size_t n = pattern.unknown_count();
    dense.assign(n, std::vector<double>(n, 0));
    const auto add_block = [&](std::uint32_t a, std::uint32_t b) {
      const auto slot = pattern.pair_slot(a, b);
      const std::uint32_t first = slot.a_first ? a : b, later = slot.a_first ? b : a;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          const double below = number(random), above = symmetric ? below : number(random);
          factor.lower()[slot.offset + r * slot.stride + c] += below;
          if (!symmetric) factor.upper()[slot.offset + r * slot.stride + c] += above;
          dense[pattern.node_unknown(later) + r][pattern.node_unknown(first) + c] += below;
          dense[pattern.node_unknown(first) + c][pattern.node_unknown(later) + r] += above;
        }
    };
    for (std::uint32_t i = 0; i < graph.node_count; ++i)
      for (int r = 0; r < 3; ++r) {
        factor.diagonals()[pattern.node_diagonal(i) + r * (pattern.node_stride(i) + 1)] += 40;
        dense[pattern.node_unknown(i) + r][pattern.node_unknown(i) + r] += 40;
      }
    for (auto [a, b] : graph.couplings) add_block(a, b);
    for (const auto& constraint : graph.constraints) {
      const auto nodes = graph.nodes_of(constraint);
      std::vector<BlockPattern::GradientSlot> gradients(nodes.size());
      const auto slot = pattern.constraint_slot(nodes, constraint.unknown, gradients.data());
      for (int r = 0; r < constraint.rows; ++r) {
        factor.diagonals()[slot.diagonal + r * (slot.stride + 1)] = -0.01;
        dense[slot.unknown + r][slot.unknown + r] = -0.01;
        for (int i = 0; i < constraint.node_count; ++i)
          for (int c = 0; c < 3; ++c) {
            const double in_row = number(random), in_column = symmetric ? in_row : number(random);
            const auto& g = gradients[i];
            const std::uint32_t at = g.offset + r * g.row_stride + c * g.column_stride;
            (g.in_diagonal ? factor.diagonals() : factor.lower())[at] = g.lower_is_row ? in_row : in_column;
            if (!symmetric)
              (g.in_diagonal ? factor.diagonals()[g.offset + g.mirror + r + c * g.row_stride] : factor.upper()[at]) =
                  g.lower_is_row ? in_column : in_row;
            dense[slot.unknown + r][pattern.node_unknown(nodes[i]) + c] = in_row;
            dense[pattern.node_unknown(nodes[i]) + c][slot.unknown + r] = in_column;
          }
      }
    }
    right_side.resize(n);
    for (double& v : right_side) v = number(random);
    for (std::size_t i = 0; i < n; ++i)  // unknowns that an adapted pattern has given up
      if (dense[i][i] == 0) dense[i][i] = 1, right_side[i] = 0;
  }

  std::vector<double> solve_densely() const {
    auto a = dense;
    auto b = right_side;
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t p = k;
      for (std::size_t i = k; i < n; ++i)
        if (std::abs(a[i][k]) > std::abs(a[p][k])) p = i;
      std::swap(a[k], a[p]), std::swap(b[k], b[p]);
      for (std::size_t i = k + 1; i < n; ++i) {
        const double l = a[i][k] / a[k][k];
        for (std::size_t j = k; j < n; ++j) a[i][j] -= l * a[k][j];
        b[i] -= l * b[k];
      }
    }
    for (std::size_t k = n; k-- > 0;) {
      for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
      b[k] /= a[k][k];
    }
    return b;
  }

  void expect_equal_solutions() {
    const std::vector<double> expected = solve_densely();
    std::vector<double> along = right_side;
    EXPECT_EQ(factor.factorize(along), 0) << "positive pivots for nodes, negative ones for constraints";
    factor.finish(along);
    std::vector<double> x = right_side;
    factor.solve(x);
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], expected[i], 1e-10);
    EXPECT_EQ(along, x) << "the same, whichever way";
  }
};

inline CouplingGraph random_graph(std::mt19937& random) {
  std::uniform_int_distribution<std::uint32_t> size(2, 25);
  CouplingGraph graph;
  graph.node_count = size(random);
  std::uniform_int_distribution<std::uint32_t> node(0, graph.node_count - 1);
  const auto pair = [&] {
    const std::uint32_t a = node(random);
    std::uint32_t b = node(random);
    while (b == a) b = node(random);
    return Edge{a, b};
  };
  for (std::uint32_t i = 0; i < graph.node_count; ++i) graph.couplings.push_back(pair());
  // Up to one row a node and nails: enough for overflowing homes, few enough to be independent.
  for (std::uint32_t i = 0; i + 1 < graph.node_count; ++i) {
    const Edge e = pair();
    graph.add(1, std::array{e[0], e[1]});
  }
  graph.add(3, std::array{node(random)});
  if (graph.node_count > 5) graph.add(3, std::array{0u, 2u, 4u});
  return graph;
}

/// A square net of side x side nodes, coupled with their neighbors, also diagonally, by blocks or by rows.
inline CouplingGraph net(std::uint32_t side, bool diagonals, bool rows) {
  CouplingGraph graph;
  graph.node_count = side * side;
  const auto tie = [&](std::uint32_t a, std::uint32_t b) {
    if (rows)
      graph.add(1, std::array{a, b});
    else
      graph.couplings.push_back({a, b});
  };
  for (std::uint32_t i = 0; i < side; ++i)
    for (std::uint32_t j = 0; j < side; ++j) {
      const std::uint32_t node = i * side + j;
      graph.places.push_back({static_cast<double>(i), 0, static_cast<double>(j)});
      if (j + 1 < side) tie(node, node + 1);
      if (i + 1 < side) tie(node, node + side);
      if (diagonals && i + 1 < side && j + 1 < side) tie(node, node + side + 1), tie(node + 1, node + side);
    }
  return graph;
}

}  // namespace iota::solver
