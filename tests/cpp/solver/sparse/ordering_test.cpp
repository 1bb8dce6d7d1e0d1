// SPDX-License-Identifier: Apache-2.0
// The order of elimination.
#include "solver/sparse/pattern_builder.h"

#include "tests/cpp/solver/sparse/dense_twin.h"

namespace iota::solver {
namespace {

std::vector<std::uint32_t> order_of(std::uint32_t n, std::span<const Edge> edges, std::span<const Vec3> places = {}) {
  std::vector<std::uint32_t> order;
  find_elimination_order(n, edges, places, order);
  return order;
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
  const auto order = order_of(5001, edges);
  EXPECT_GE(std::find(order.begin(), order.end(), 0u) - order.begin(), 4999);
}

TEST(Ordering, is_a_permutation_of_any_graph) {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    const CouplingGraph graph = random_graph(random);
    auto order = order_of(graph.node_count, graph.couplings);
    std::sort(order.begin(), order.end());
    for (std::uint32_t i = 0; i < graph.node_count; ++i) ASSERT_EQ(order[i], i);
  }
}

// Small graphs are matrices of bits, larger ones lists.
TEST(Ordering, of_a_small_graph_is_that_of_a_part_of_a_large_one) {
  std::mt19937 random(4);
  for (std::uint32_t n = 2; n <= 256; n += 1 + n / 16) {
    std::vector<Edge> edges;
    for (std::uint32_t i = 1; i < n; ++i) edges.push_back({static_cast<std::uint32_t>(random() % i), i});
    for (std::uint32_t i = 0; i < 2 * n; ++i)
      edges.push_back({static_cast<std::uint32_t>(random() % n), static_cast<std::uint32_t>(random() % n)});
    auto in_large = order_of(n + 256, edges);
    std::erase_if(in_large, [&](std::uint32_t node) { return node >= n; });
    ASSERT_EQ(order_of(n, edges), in_large) << n << " nodes";
  }
}

TEST(Ordering, is_a_permutation_of_a_net_that_is_dissected) {
  const CouplingGraph graph = net(60, true, false);
  auto order = order_of(graph.node_count, graph.couplings, graph.places);
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

}  // namespace
}  // namespace iota::solver
