// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_factor.h"
#include "solver/sparse/block_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace iota::solver {
namespace {

using Edge = std::array<std::uint32_t, 2>;

/// A matrix with the structure [A G'; G -C] in two forms: in the block pattern, and dense in the pattern's unknowns.
struct Twin {
  BlockPattern pattern;
  BlockFactor factor;
  std::vector<std::vector<double>> dense;
  std::vector<double> right_side;

  Twin(const CouplingGraph& graph, bool symmetric, std::mt19937& random) {
    pattern.analyze(graph);
    std::vector<BlockPattern::ConstraintSlot> slots;
    for (std::size_t k = 0; k < graph.constraints.size(); ++k) slots.push_back(pattern.constraint_slot(k));
    fill(graph, slots, symmetric, random);
  }
  Twin(const BlockPattern& given, const CouplingGraph& graph, const std::vector<BlockPattern::ConstraintSlot>& slots,
       bool symmetric, std::mt19937& random)
      : pattern(given) {
    fill(graph, slots, symmetric, random);
  }

  void fill(const CouplingGraph& graph, const std::vector<BlockPattern::ConstraintSlot>& slots, bool symmetric,
            std::mt19937& random) {
    std::uniform_real_distribution<double> number(-1, 1);
    factor.reset(pattern);
    factor.clear(symmetric);
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
    for (std::size_t k = 0; k < graph.constraints.size(); ++k) {
      const auto& constraint = graph.constraints[k];
      const auto& slot = slots[k];
      for (int r = 0; r < constraint.rows; ++r) {
        factor.diagonals()[slot.diagonal + r * (slot.stride + 1)] = -0.01;
        dense[slot.unknown + r][slot.unknown + r] = -0.01;
        for (int i = 0; i < constraint.node_count; ++i)
          for (int c = 0; c < 3; ++c) {
            const double in_row = number(random), in_column = symmetric ? in_row : number(random);
            const auto& g = slot.gradients[i];
            const std::uint32_t at = g.offset + r * g.row_stride + c * g.column_stride;
            (g.in_diagonal ? factor.diagonals() : factor.lower())[at] = g.lower_is_row ? in_row : in_column;
            if (!symmetric)
              (g.in_diagonal ? factor.diagonals()[g.offset + g.mirror + r + c * g.row_stride] : factor.upper()[at]) =
                  g.lower_is_row ? in_column : in_row;
            dense[slot.unknown + r][pattern.node_unknown(constraint.nodes[i]) + c] = in_row;
            dense[pattern.node_unknown(constraint.nodes[i]) + c][slot.unknown + r] = in_column;
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

/// What two leaves hold, one after the other, before or after elimination.
template <int Pivot>
struct TwoLeaves {
  std::array<std::array<double, Pivot * Pivot>, 2> diagonal;
  std::array<std::array<double, 3 * Pivot>, 2> lower, upper;
  std::array<double, 9> target;  // of both
  std::array<std::array<double, Pivot>, 2> own;
  std::array<double, 3> later;

  template <int N>
  Leaves<Pivot, N> from(std::size_t first) {
    Leaves<Pivot, N> leaves;
    for (std::size_t lane = 0; lane < N; ++lane) {
      leaves.diagonal[lane] = diagonal[first + lane].data();
      leaves.lower[lane] = lower[first + lane].data(), leaves.upper[lane] = upper[first + lane].data();
      leaves.target[lane] = target.data(), leaves.target_stride[lane] = 3;
      leaves.own[lane] = own[first + lane].data(), leaves.later[lane] = later.data();
    }
    return leaves;
  }
  bool operator==(const TwoLeaves&) const = default;
};

template <int Pivot, bool Symmetric>
void expect_equal_bits_in_lanes(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  TwoLeaves<Pivot> together;
  for (std::size_t leaf = 0; leaf < 2; ++leaf) {
    for (double& v : together.diagonal[leaf]) v = number(random);
    for (std::size_t k = 0; k < Pivot; ++k) together.diagonal[leaf][k * (Pivot + 1)] += k < 3 ? 5 : -5;
    for (auto* list : {&together.lower[leaf], &together.upper[leaf]})
      for (double& v : *list) v = number(random);
    for (double& v : together.own[leaf]) v = number(random);
  }
  for (double& v : together.target) v = number(random);
  for (double& v : together.later) v = number(random);
  TwoLeaves<Pivot> alone = together;
  const auto pair = together.template from<2>(0);
  EXPECT_EQ(pair.template eliminate<Symmetric>(3), 0);
  pair.template finish<Symmetric>();
  const auto first = alone.template from<1>(0), second = alone.template from<1>(1);
  EXPECT_EQ(first.template eliminate<Symmetric>(3) + second.template eliminate<Symmetric>(3), 0);
  first.template finish<Symmetric>(), second.template finish<Symmetric>();
  EXPECT_TRUE(together == alone);
}

TEST(Leaves, get_the_same_bits_in_lanes_as_alone) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    expect_equal_bits_in_lanes<3, true>(random), expect_equal_bits_in_lanes<3, false>(random);
    expect_equal_bits_in_lanes<4, true>(random), expect_equal_bits_in_lanes<4, false>(random);
    expect_equal_bits_in_lanes<6, true>(random), expect_equal_bits_in_lanes<6, false>(random);
  }
}

CouplingGraph random_graph(std::mt19937& random) {
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
    graph.constraints.push_back({1, 2, {e[0], e[1]}});
  }
  graph.constraints.push_back({3, 1, {node(random)}});
  if (graph.node_count > 5) graph.constraints.push_back({3, 3, {0, 2, 4}});
  return graph;
}

TEST(BlockFactor, equals_a_dense_solve_on_random_symmetric_matrices) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) Twin(random_graph(random), true, random).expect_equal_solutions();
}

TEST(BlockFactor, equals_a_dense_solve_on_random_unsymmetric_matrices) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    Twin twin(random_graph(random), false, random);
    const std::vector<double> expected = twin.solve_densely();
    (void)twin.factor.factorize();
    std::vector<double> x = twin.right_side;
    twin.factor.solve(x);
    double largest = 0;
    for (const double v : expected) largest = std::max(largest, std::abs(v));
    for (std::size_t k = 0; k < x.size(); ++k) ASSERT_NEAR(x[k], expected[k], 1e-7 * (1 + largest));
  }
}

TEST(Ordering, of_a_chain_makes_no_fill) {
  const std::uint32_t n = 1000;
  CouplingGraph graph;
  graph.node_count = n;
  for (std::uint32_t i = 0; i + 1 < n; ++i) graph.constraints.push_back({1, 2, {i, i + 1}});
  BlockPattern pattern;
  pattern.analyze(graph);
  EXPECT_EQ(pattern.entries().size(), n - 1);
  EXPECT_EQ(pattern.widest_front(), 3u);
}

TEST(Ordering, of_a_star_keeps_the_hub_for_last) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 1; i <= 5000; ++i) edges.push_back({0, i});
  const auto order = minimum_degree_order(5001, edges);
  EXPECT_GE(std::find(order.begin(), order.end(), 0u) - order.begin(), 4999);
}

TEST(Ordering, is_a_permutation_of_any_graph) {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    const CouplingGraph graph = random_graph(random);
    auto order = minimum_degree_order(graph.node_count, graph.couplings);
    std::sort(order.begin(), order.end());
    for (std::uint32_t i = 0; i < graph.node_count; ++i) ASSERT_EQ(order[i], i);
  }
}

/// A tree of nodes with a row on each edge, and what a cut or a merger of nodes changes in it.
struct ChangingTree {
  CouplingGraph graph;
  BlockPattern pattern;
  std::vector<BlockPattern::ConstraintSlot> slots;
  int adapted = 0;

  ChangingTree(std::mt19937& random, std::uint32_t nodes) {
    graph.node_count = nodes;
    for (std::uint32_t n = 1; n < nodes; ++n) {
      const std::uint32_t reach = std::min<std::uint32_t>(n, 3);
      const std::uint32_t to = n - 1 - static_cast<std::uint32_t>(random() % reach);
      graph.constraints.push_back({1, 2, {to, n}});
      graph.couplings.push_back({to, n});
    }
    analyze();
  }
  void analyze() {
    pattern.analyze(graph);
    slots.clear();
    for (std::size_t k = 0; k < graph.constraints.size(); ++k) slots.push_back(pattern.constraint_slot(k));
  }
  bool are_joined(std::uint32_t a, std::uint32_t b) const {
    return std::any_of(graph.couplings.begin(), graph.couplings.end(),
                       [&](const Edge& e) { return (e[0] == a && e[1] == b) || (e[0] == b && e[1] == a); });
  }
  /// Edge k now ends at `to` instead of `from`.
  void move(std::size_t k, std::uint32_t from, std::uint32_t to) {
    for (int i = 0; i < 2; ++i)
      if (graph.couplings[k][i] == from) graph.couplings[k][i] = graph.constraints[k].nodes[i] = to;
  }
  void finish(GraphChange& change) {
    std::vector<std::uint32_t> around(change.touched);
    const auto is_in = [](const std::vector<std::uint32_t>& list, std::uint32_t n) {
      return std::find(list.begin(), list.end(), n) != list.end();
    };
    for (const Edge& e : graph.couplings)
      if (is_in(change.touched, e[0]) || is_in(change.touched, e[1])) around.push_back(e[0]), around.push_back(e[1]);
    std::vector<std::size_t> numbers;
    for (std::size_t k = 0; k < graph.couplings.size(); ++k) {
      const auto [a, b] = graph.couplings[k];
      if (!is_in(around, a) && !is_in(around, b)) continue;
      change.constraints.push_back({{a, b}, slots[k].unknown});
      numbers.push_back(k);
    }
    change.neighbors = [&](std::uint32_t node, std::vector<std::uint32_t>& with) {
      for (const auto [a, b] : graph.couplings)
        if (a == node || b == node) with.push_back(a == node ? b : a);
    };
    const bool followed = pattern.adapt(change);
    adapted += followed;
    if (followed) {
      for (std::size_t i = 0; i < numbers.size(); ++i) slots[numbers[i]] = pattern.adapted_slot(i);
      for (std::size_t k = 0; k < slots.size(); ++k) {
        const auto [a, b] = graph.couplings[k];
        const bool has_new_slot = std::find(numbers.begin(), numbers.end(), k) != numbers.end();
        if (!has_new_slot && (pattern.moved()[a] || pattern.moved()[b]))
          slots[k] = pattern.find_slot(std::array{a, b}, slots[k].unknown);
      }
      pattern.renumber(change.removed);
    }
    for (const std::uint32_t gone : change.removed) {  // one at most
      const std::uint32_t last = --graph.node_count;
      for (std::size_t k = 0; k < graph.couplings.size(); ++k) move(k, last, gone);
    }
    if (!followed) analyze();
  }
  void cut(std::mt19937& random) {
    const auto node = static_cast<std::uint32_t>(random() % graph.node_count);
    GraphChange change;
    const std::uint32_t fresh = graph.node_count++;
    change.added = {{fresh, node}};
    change.touched = {node, fresh};
    for (std::size_t k = 0; k < graph.couplings.size(); ++k)
      if (random() % 2) move(k, node, fresh);
    for (const auto [a, b] : graph.couplings) {
      for (const std::uint32_t end : {a, b})
        if (end == node || end == fresh) change.touched.push_back(a + b - end);
    }
    finish(change);
  }
  void merge(std::mt19937& random) {
    const auto into = static_cast<std::uint32_t>(random() % graph.node_count);
    const auto gone = static_cast<std::uint32_t>(random() % graph.node_count);
    if (into == gone || are_joined(into, gone)) return;
    for (std::uint32_t n = 0; n < graph.node_count; ++n)
      if (are_joined(n, into) && are_joined(n, gone)) return;
    GraphChange change;
    change.removed = {gone};
    change.touched = {into, gone};
    for (std::size_t k = 0; k < graph.couplings.size(); ++k) {
      const auto [a, b] = graph.couplings[k];
      if (a == gone || b == gone) change.touched.push_back(a + b - gone);
      move(k, gone, into);
    }
    finish(change);
  }
};

TEST(BlockPattern, adapted_to_cuts_and_mergers_factors_like_a_dense_matrix) {
  std::mt19937 random(11);
  int adapted = 0;
  for (int trial = 0; trial < 20; ++trial) {
    ChangingTree tree(random, 30);
    for (int edit = 0; edit < 25; ++edit) {
      random() % 2 ? tree.cut(random) : tree.merge(random);
      Twin(tree.pattern, tree.graph, tree.slots, true, random).expect_equal_solutions();
      if (testing::Test::HasFatalFailure()) return;
    }
    adapted += tree.adapted;
  }
  EXPECT_GT(adapted, 200) << "most changes are followed without a new analysis";
}

}  // namespace
}  // namespace iota::solver
