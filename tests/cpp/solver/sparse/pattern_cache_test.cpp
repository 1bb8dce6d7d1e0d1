// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/pattern_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace iota::solver {
namespace {

CouplingGraph chain(std::uint32_t nodes) {
  CouplingGraph graph;
  graph.node_count = nodes;
  for (std::uint32_t n = 1; n < nodes; ++n) (void)graph.add(1, std::array{n - 1, n});
  return graph;
}

/// The pattern of a graph that came before.
std::shared_ptr<const BlockPattern> find_again(PatternCache& cache, CouplingGraph& graph) {
  (void)cache.find(graph);
  return cache.find(graph);
}

TEST(PatternCache, keeps_graphs_from_their_second_time_on) {
  PatternCache cache;
  CouplingGraph graph = chain(5);
  EXPECT_EQ(cache.find(graph), nullptr);
  EXPECT_NE(cache.find(graph), nullptr);
}

TEST(PatternCache, gives_equal_graphs_one_pattern_and_the_same_unknowns) {
  PatternCache cache;
  CouplingGraph a = chain(5), b = chain(5), other = chain(6);
  const auto pattern = find_again(cache, a);
  EXPECT_EQ(cache.find(b), pattern);
  EXPECT_NE(find_again(cache, other), pattern);
  for (std::size_t i = 0; i < a.constraints.size(); ++i) EXPECT_EQ(a.constraints[i].unknown, b.constraints[i].unknown);
}

TEST(PatternCache, leaves_large_graphs_to_their_problems) {
  PatternCache cache;
  CouplingGraph large = chain(PatternCache::most_nodes + 1);
  EXPECT_EQ(find_again(cache, large), nullptr);
}

// More graphs than there is room for; some patterns are in use all the time.
TEST(PatternCache, takes_the_room_of_patterns_that_nothing_uses) {
  PatternCache cache;
  const auto graph_of = [](std::uint32_t number) {
    CouplingGraph graph = chain(18);
    for (std::uint32_t bit = 0; bit < 16; ++bit)
      if (number >> bit & 1) (void)graph.add(1, std::array{bit, bit + 2});
    return graph;
  };
  std::vector<std::shared_ptr<const BlockPattern>> used;
  for (std::uint32_t number = 0; number < 20000; ++number) {
    CouplingGraph graph = graph_of(number);
    const auto pattern = find_again(cache, graph);
    ASSERT_NE(pattern, nullptr) << number;
    if (number % 500 == 0) used.push_back(pattern);
  }
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    CouplingGraph graph = graph_of(500 * i);
    BlockPattern analyzed;
    analyzed.analyze(graph);
    ASSERT_EQ(used[i]->fill(), analyzed.fill());
    ASSERT_EQ(used[i]->vertices().size(), analyzed.vertices().size());
  }
}

// Random graphs that differ in one number only, each against an analysis.
TEST(PatternCache, gives_what_an_analysis_gives) {
  PatternCache cache;
  std::mt19937 random(4);
  for (int round = 0; round < 300; ++round) {
    CouplingGraph graph = chain(2 + random() % 8);
    for (std::uint32_t i = random() % 3; i > 0; --i) {
      const auto a = static_cast<std::uint32_t>(random() % graph.node_count);
      const auto b = (a + 1) % graph.node_count;
      if (random() % 2) {
        graph.couplings.push_back({a, b});
        continue;
      }
      auto& c = graph.add(static_cast<std::uint8_t>(1 + random() % 3), std::array{a, b});
      c.apart = random() % 2, c.first_side = c.apart ? random() % 2 : 0;
      c.always_behind_first_side = c.first_side && random() % 2;
    }
    CouplingGraph twin = graph;
    const auto pattern = find_again(cache, graph);
    BlockPattern analyzed;
    analyzed.analyze(twin);
    for (std::size_t i = 0; i < graph.constraints.size(); ++i)
      ASSERT_EQ(graph.constraints[i].unknown, twin.constraints[i].unknown) << "round " << round;
    ASSERT_EQ(pattern->vertices().size(), analyzed.vertices().size());
    for (std::size_t v = 0; v < analyzed.vertices().size(); ++v) {
      const auto &mine = pattern->vertices()[v], &its = analyzed.vertices()[v];
      ASSERT_EQ(mine.pivot, its.pivot);
      ASSERT_EQ(mine.unknown, its.unknown);
      ASSERT_EQ(mine.diagonal, its.diagonal);
      ASSERT_EQ(mine.entry_count, its.entry_count);
    }
    const auto have = pattern->pair_targets(), want = analyzed.pair_targets();
    ASSERT_TRUE(std::equal(have.begin(), have.end(), want.begin(), want.end()));
  }
}

}  // namespace
}  // namespace iota::solver
