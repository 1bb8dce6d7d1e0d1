// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_factor.h"
#include "solver/sparse/block_pattern.h"
#include "solver/sparse/panel_product.h"
#include "solver/sparse/pattern_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

namespace iota::solver {
namespace {

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
    graph.add(1, std::array{e[0], e[1]});
  }
  graph.add(3, std::array{node(random)});
  if (graph.node_count > 5) graph.add(3, std::array{0u, 2u, 4u});
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
  for (std::uint32_t i = 0; i + 1 < n; ++i) graph.add(1, std::array{i, i + 1});
  BlockPattern pattern;
  pattern.analyze(graph);
  EXPECT_EQ(pattern.entries().size(), n - 1);
  EXPECT_EQ(pattern.widest_front(), 3u);
}

TEST(Ordering, of_a_star_keeps_the_hub_for_last) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 1; i <= 5000; ++i) edges.push_back({0, i});
  const auto order = elimination_order(5001, edges, {});
  EXPECT_GE(std::find(order.begin(), order.end(), 0u) - order.begin(), 4999);
}

TEST(Ordering, is_a_permutation_of_any_graph) {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    const CouplingGraph graph = random_graph(random);
    auto order = elimination_order(graph.node_count, graph.couplings, {});
    std::sort(order.begin(), order.end());
    for (std::uint32_t i = 0; i < graph.node_count; ++i) ASSERT_EQ(order[i], i);
  }
}

/// A square net of side x side nodes, coupled with their neighbors, also diagonally, by blocks or by rows.
CouplingGraph net(std::uint32_t side, bool diagonals, bool rows) {
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

TEST(Panels, give_the_solution_of_a_dense_one) {
  std::mt19937 random(17);
  for (const bool symmetric : {true, false})
    for (const bool diagonals : {false, true})
      for (const bool rows : {false, true}) {
        if (rows && !symmetric) continue;  // pivots of random rows may then have any sign
        Twin twin(net(9, diagonals, rows), symmetric, random);
        EXPECT_FALSE(twin.pattern.panels().empty());
        twin.expect_equal_solutions();
      }
}

TEST(Panels, hold_all_wide_vertices_and_nothing_twice) {
  BlockPattern pattern;
  CouplingGraph graph = net(40, true, true);
  pattern.analyze(graph);
  std::vector<int> times(pattern.vertices().size(), 0);
  std::uint32_t last_before = 0;
  for (const auto& panel : pattern.panels()) {
    const auto members = pattern.panel_vertices().subspan(panel.first, panel.count);
    std::uint32_t columns = 0;
    for (const std::uint32_t v : members) ++times[v], columns += pattern.vertices()[v].pivot;
    EXPECT_EQ(columns, panel.columns);
    EXPECT_LE(last_before, members.back()) << "in order of elimination";
    last_before = members.back();
    for (std::size_t i = 0; i + 1 < members.size(); ++i)
      EXPECT_EQ(pattern.entries()[pattern.vertices()[members[i]].first_entry].vertex, members[i + 1]);
  }
  for (std::size_t v = 0; v < times.size(); ++v) {
    EXPECT_LE(times[v], 1);
    if (pattern.vertices()[v].is_wide()) EXPECT_EQ(times[v], 1);
  }
}

TEST(Panels, multiply_like_three_loops_in_every_size) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int rows : {1, 3, 15, 16, 17, 40, 48})
    for (int columns = 1; columns <= 6; ++columns)
      for (int depth : {1, 2, 7}) {
        const std::size_t stride = 48;
        std::vector<double> x(stride * 8 + panel_slack), y(stride * 8), t(stride * 8);
        for (double& v : x) v = number(random);
        for (double& v : y) v = number(random);
        multiply_panel(t.data(), x.data(), y.data(), rows, columns, depth, stride);
        for (int r = 0; r < rows; ++r)
          for (int c = 0; c < columns; ++c) {
            double sum = 0;
            for (int k = 0; k < depth; ++k) sum += x[k * stride + r] * y[k * stride + c];
            ASSERT_EQ(t[c * stride + r], sum) << "the same bits on all processors";
          }
      }
}

TEST(Ordering, is_a_permutation_of_a_net_that_is_dissected) {
  const CouplingGraph graph = net(60, true, false);
  auto order = elimination_order(graph.node_count, graph.couplings, graph.places);
  ASSERT_EQ(order.size(), graph.node_count);
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < graph.node_count; ++i) ASSERT_EQ(order[i], i);
}

// Fill of a net grows as n log n by theory (George 1973).
TEST(Ordering, makes_fill_of_a_net_grow_as_n_log_n) {
  for (const std::uint32_t side : {20, 40, 80, 120}) {
    CouplingGraph graph = net(side, false, false);
    BlockPattern pattern;
    pattern.analyze(graph);
    const double n = side * side;
    EXPECT_LT(static_cast<double>(pattern.entries().size()), 2.1 * n * std::log2(n)) << side;
  }
}

TEST(Ordering, keeps_going_where_all_places_are_one_and_all_nodes_couple) {
  CouplingGraph graph;
  graph.node_count = 300;
  graph.places.assign(300, {1, 2, 3});
  for (std::uint32_t i = 0; i < 300; ++i)
    for (std::uint32_t j = 0; j < i; ++j) graph.couplings.push_back({j, i});
  BlockPattern pattern;
  pattern.analyze(graph);
  EXPECT_EQ(pattern.entries().size(), 300u * 299u / 2);
}

/// A graph whose nodes, couplings and constraints of all kinds come and go, and the pattern that follows.
struct ChangingGraph {
  CouplingGraph graph;
  BlockPattern pattern;
  GraphChange change;
  int followed = 0, analyzed = 0;

  ChangingGraph(std::mt19937& random, std::uint32_t nodes) {
    graph.node_count = nodes;
    for (std::uint32_t n = 1; n < nodes; ++n) {
      const std::uint32_t to = n - 1 - static_cast<std::uint32_t>(random() % std::min<std::uint32_t>(n, 3));
      graph.couplings.push_back({to, n});
      graph.add(1, std::array{to, n});
    }
    pattern.analyze(graph);
  }

  void touch(std::uint32_t node) { change.touched.push_back(node); }
  void touch(const CouplingGraph::Constraint& c) {
    for (const std::uint32_t node : graph.nodes_of(c)) touch(node);
  }
  std::uint32_t any_node(std::mt19937& random) const { return static_cast<std::uint32_t>(random() % graph.node_count); }

  /// Up to two rows, on nodes that are near each other in number.
  void add_constraint(std::mt19937& random) {
    const auto rows = static_cast<std::uint8_t>(1 + random() % 2);
    std::vector<std::uint32_t> nodes;
    const std::uint32_t first = any_node(random), wanted = 2 + static_cast<std::uint32_t>(random() % 4);
    for (std::uint32_t i = 0; i < wanted; ++i) {
      const auto node = static_cast<std::uint32_t>((first + i * (1 + random() % 3)) % graph.node_count);
      if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
    }
    CouplingGraph::Constraint& c = graph.add(rows, nodes);
    c.apart = random() % 3 == 0;
    c.first_side = c.apart ? static_cast<std::uint8_t>(random() % c.node_count) : std::uint8_t{0};
    touch(c);
  }
  void remove_constraint(std::size_t k) {
    touch(graph.constraints[k]);
    change.removed_rows.push_back(graph.constraints[k].unknown);
    graph.constraints[k] = graph.constraints.back();
    graph.constraints.pop_back();
  }
  void rename(std::uint32_t from, std::uint32_t to) {
    for (auto& c : graph.couplings)
      for (std::uint32_t& node : c)
        if (node == from) node = to;
    std::replace(graph.nodes.begin(), graph.nodes.end(), from, to);
  }
  /// Half of what ends at a node ends at a new one instead.
  void split(std::uint32_t node, std::mt19937& random) {
    const std::uint32_t fresh = graph.node_count++;
    change.added.push_back({fresh, node});
    touch(node), touch(fresh);
    for (auto& c : graph.couplings)
      if ((c[0] == node || c[1] == node) && random() % 2) touch(c[0]), touch(c[1]), c[c[1] == node] = fresh;
    for (auto& c : graph.constraints) {
      const auto nodes = graph.nodes_of(c);
      const auto end = nodes.end(), at = std::find(nodes.begin(), end, node);
      if (at == end || random() % 2) continue;
      touch(c);
      *at = fresh;
      change.removed_rows.push_back(std::exchange(c.unknown, CouplingGraph::no_unknown));
    }
  }
  /// All that ends at `gone` ends at `into` instead, where nothing holds both.
  void merge(std::uint32_t gone, std::uint32_t into) {
    const auto has = [](const auto& begin, const auto& end, std::uint32_t node) {
      return std::find(begin, end, node) != end;
    };
    for (const auto& c : graph.couplings)
      if (has(c.begin(), c.end(), gone) && has(c.begin(), c.end(), into)) return;
    for (const auto& c : graph.constraints) {
      const auto nodes = graph.nodes_of(c);
      if (has(nodes.begin(), nodes.end(), gone) && has(nodes.begin(), nodes.end(), into)) return;
    }
    touch(into);
    for (auto& c : graph.couplings)
      if (has(c.begin(), c.end(), gone)) touch(c[0]), touch(c[1]);
    for (auto& c : graph.constraints) {
      const auto nodes = graph.nodes_of(c);
      if (!has(nodes.begin(), nodes.end(), gone)) continue;
      touch(c);
      change.removed_rows.push_back(std::exchange(c.unknown, CouplingGraph::no_unknown));
    }
    rename(gone, into);
    change.removed.push_back(gone);
  }

  void edit(std::mt19937& random) {
    switch (random() % 5) {
      case 0: return split(any_node(random), random);
      case 1:
        if (const auto gone = any_node(random), into = any_node(random); gone != into) merge(gone, into);
        return;
      case 2:
        if (graph.constraints.size() > graph.node_count / 2) remove_constraint(random() % graph.constraints.size());
        return;
      case 3:
        if (const auto a = any_node(random), b = any_node(random); a != b) {
          graph.couplings.push_back({a, b});
          touch(a), touch(b);
        }
        return;
      default:
        if (graph.constraints.size() < graph.node_count + 3) add_constraint(random);
    }
  }
  void follow() {
    const bool suits = pattern.follow(graph, change);
    if (change.removed.size() == 1) rename(--graph.node_count, change.removed.front());
    change.clear();
    ++(suits ? followed : analyzed);
    if (!suits) pattern.analyze(graph);
  }
};

TEST(BlockPattern, following_random_changes_factors_like_a_dense_matrix) {
  std::mt19937 random(11);
  int followed = 0, analyzed = 0;
  for (int trial = 0; trial < 12; ++trial) {
    ChangingGraph changing(random, 30);
    for (int edit = 0; edit < 30; ++edit) {
      changing.edit(random);
      changing.follow();
      Twin(changing.pattern, changing.graph, true, random).expect_equal_solutions();
      if (testing::Test::HasFatalFailure()) return;
    }
    followed += changing.followed, analyzed += changing.analyzed;
  }
  EXPECT_GT(followed, 20 * analyzed);
}

/// What couples with touched nodes and with the nodes of their constraints, and then all the rest.
struct Parts {
  CouplingGraph graph;
  std::vector<std::size_t> source;  ///< of each constraint: its place in the whole graph
  std::function<void()> complete;

  Parts(const CouplingGraph& whole, const GraphChange& change) {
    std::vector<bool> touched(whole.node_count), near(whole.node_count);
    for (const std::uint32_t node : change.touched) touched[node] = near[node] = true;
    const auto any = [](const auto& nodes, const std::vector<bool>& marks) {
      return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return marks[node]; });
    };
    for (const auto& c : whole.constraints)
      if (any(whole.nodes_of(c), touched))
        for (const std::uint32_t node : whole.nodes_of(c)) near[node] = true;
    graph.node_count = whole.node_count;
    const auto add = [this, &whole, near, any](bool which) {
      for (const auto& c : whole.couplings)
        if (any(c, near) == which) graph.couplings.push_back(c);
      for (std::size_t k = 0; k < whole.constraints.size(); ++k) {
        const auto& c = whole.constraints[k];
        if (any(whole.nodes_of(c), near) != which) continue;
        const auto first = graph.add(c.rows, whole.nodes_of(c)).first_node;
        graph.constraints.back() = c;
        graph.constraints.back().first_node = first;
        source.push_back(k);
      }
    };
    add(true);
    complete = [add] { add(false); };
  }
};

TEST(BlockPattern, follows_what_is_near_a_change_as_it_follows_the_whole_graph) {
  std::mt19937 random(14);
  ChangingGraph changing(random, 200);
  int stayed_near = 0;
  for (int edit = 0; edit < 300; ++edit) {
    changing.edit(random);
    Parts parts(changing.graph, changing.change);
    BlockPattern pattern = changing.pattern;
    const bool suits = PatternBuilder::follow_part(pattern, parts.graph, changing.change, parts.complete);
    stayed_near += parts.graph.constraints.size() < changing.graph.constraints.size();
    ASSERT_EQ(suits, changing.pattern.follow(changing.graph, changing.change));
    ASSERT_EQ(pattern.vertices().size(), changing.pattern.vertices().size());
    for (std::size_t k = 0; k < parts.source.size(); ++k)
      ASSERT_EQ(parts.graph.constraints[k].unknown, changing.graph.constraints[parts.source[k]].unknown);
    for (std::size_t v = 0; v < pattern.vertices().size(); ++v) {
      const BlockPattern::Vertex &mine = pattern.vertices()[v], &its = changing.pattern.vertices()[v];
      ASSERT_EQ(mine.unknown, its.unknown);
      ASSERT_EQ(mine.diagonal, its.diagonal);
      ASSERT_EQ(mine.entry_count, its.entry_count);
      for (std::uint32_t e = 0; e < mine.entry_count; ++e) {
        const auto &entry = pattern.entries()[mine.first_entry + e],
                   &other = changing.pattern.entries()[its.first_entry + e];
        ASSERT_EQ(entry.vertex, other.vertex);
        ASSERT_EQ(entry.offset, other.offset);
      }
    }
    if (changing.change.removed.size() == 1) changing.rename(--changing.graph.node_count, changing.change.removed[0]);
    changing.change.clear();
    if (!suits) changing.pattern.analyze(changing.graph);
  }
  EXPECT_GT(stayed_near, 30) << "the rest was asked for each time";
  EXPECT_LT(stayed_near, 300) << "and never";
}

TEST(BlockPattern, that_has_followed_and_gone_back_is_no_larger) {
  std::mt19937 random(12);
  ChangingGraph changing(random, 200);
  const std::uint32_t fill = changing.pattern.fill();
  std::uint32_t unknowns = 0, values = 0;
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 4; ++i) changing.add_constraint(random);
    changing.follow();
    for (int i = 0; i < 4; ++i) changing.remove_constraint(changing.graph.constraints.size() - 1);
    changing.follow();
    ASSERT_EQ(changing.pattern.fill(), fill) << "round " << round;
    if (round == 25) unknowns = changing.pattern.unknown_count(), values = changing.pattern.lower_count();
  }
  EXPECT_LT(changing.pattern.unknown_count(), unknowns + unknowns / 10) << "space that was given back is used again";
  EXPECT_LT(changing.pattern.lower_count(), values + values / 10);
}

/// A chain that is closed to a ring and cut elsewhere: the change spreads along half of the chain.
TEST(BlockPattern, follows_a_chain_closed_to_a_ring_and_opened_again) {
  std::mt19937 random(13);
  CouplingGraph graph;
  graph.node_count = 60;
  for (std::uint32_t n = 1; n < graph.node_count; ++n) {
    graph.couplings.push_back({n - 1, n});
    graph.add(1, std::array{n - 1, n});
  }
  BlockPattern pattern;
  pattern.analyze(graph);
  const std::uint32_t fill = pattern.fill();
  graph.add(1, std::array{0u, 59u});
  (void)pattern.follow(graph, {.touched = {0, 59}});
  Twin(pattern, graph, true, random).expect_equal_solutions();
  CouplingGraph anew = graph;
  BlockPattern analyzed;
  analyzed.analyze(anew);
  EXPECT_LE(pattern.fill(), analyzed.fill() + analyzed.fill() / 4);
  const std::uint32_t unknown = graph.constraints.back().unknown;
  graph.constraints.pop_back();
  (void)pattern.follow(graph, {.touched = {0, 59}, .removed_rows = {unknown}});
  Twin(pattern, graph, true, random).expect_equal_solutions();
  EXPECT_EQ(pattern.fill(), fill);
}

}  // namespace
}  // namespace iota::solver
