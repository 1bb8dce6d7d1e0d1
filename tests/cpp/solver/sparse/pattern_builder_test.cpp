// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/pattern_builder.h"

#include "tests/cpp/solver/sparse/dense_twin.h"

#include <numeric>

namespace iota::solver {
namespace {

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

  void note(std::uint32_t node) { change.changed.push_back(node); }
  void note(const CouplingGraph::Constraint& c) {
    for (const std::uint32_t node : graph.nodes_of(c)) note(node);
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
    note(c);
  }
  void remove_constraint(std::size_t k) {
    note(graph.constraints[k]);
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
    change.added.push_back({fresh, random() % 3 ? node : GraphChange::front});
    note(node), note(fresh);
    for (auto& c : graph.couplings)
      if ((c[0] == node || c[1] == node) && random() % 2) note(c[0]), note(c[1]), c[c[1] == node] = fresh;
    for (auto& c : graph.constraints) {
      const auto nodes = graph.nodes_of(c);
      const auto end = nodes.end(), at = std::find(nodes.begin(), end, node);
      if (at == end || random() % 2) continue;
      note(c);
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
    note(into);
    for (auto& c : graph.couplings)
      if (has(c.begin(), c.end(), gone)) note(c[0]), note(c[1]);
    for (auto& c : graph.constraints) {
      const auto nodes = graph.nodes_of(c);
      if (!has(nodes.begin(), nodes.end(), gone)) continue;
      note(c);
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
          note(a), note(b);
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
  EXPECT_GT(followed, 10 * analyzed);
}

/// What couples with changed nodes and with the nodes of their constraints, and then all the rest.
struct Parts {
  CouplingGraph graph;
  std::vector<std::size_t> source;  ///< of each constraint: its place in the whole graph
  std::function<void()> complete;

  Parts(const CouplingGraph& whole, const GraphChange& change) {
    std::vector<bool> changed(whole.node_count), near(whole.node_count);
    for (const std::uint32_t node : change.changed) changed[node] = near[node] = true;
    const auto any = [](const auto& nodes, const std::vector<bool>& marks) {
      return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return marks[node]; });
    };
    for (const auto& c : whole.constraints)
      if (any(whole.nodes_of(c), changed))
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

TEST(BlockPattern, follows_a_local_change_as_it_follows_the_whole_graph) {
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
  (void)pattern.follow(graph, {.changed = {0, 59}});
  Twin(pattern, graph, true, random).expect_equal_solutions();
  CouplingGraph anew = graph;
  BlockPattern analyzed;
  analyzed.analyze(anew);
  EXPECT_LE(pattern.fill(), analyzed.fill() + analyzed.fill() / 4);
  const std::uint32_t unknown = graph.constraints.back().unknown;
  graph.constraints.pop_back();
  (void)pattern.follow(graph, {.changed = {0, 59}, .removed_rows = {unknown}});
  Twin(pattern, graph, true, random).expect_equal_solutions();
  EXPECT_EQ(pattern.fill(), fill);
}

TEST(PatternBuilder, eliminates_nodes_in_an_order_that_is_given_and_gives_the_pattern_that_had_it) {
  std::mt19937 random(5);
  ChangingGraph some(random, 40);
  CouplingGraph& graph = some.graph;
  std::vector<std::uint32_t> order(graph.node_count);
  std::iota(order.begin(), order.end(), 0u);
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) {
    return some.pattern.node_rank(a) < some.pattern.node_rank(b);
  };
  std::sort(order.begin(), order.end(), by_rank);
  BlockPattern again, other;
  graph.order.nodes = order;
  again.analyze(graph);
  EXPECT_EQ(again.fill(), some.pattern.fill());
  for (std::uint32_t n = 0; n < graph.node_count; ++n) EXPECT_EQ(again.node_rank(n), some.pattern.node_rank(n));
  std::shuffle(graph.order.nodes.begin(), graph.order.nodes.end(), random);
  other.analyze(graph);
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_LT(other.node_rank(graph.order.nodes[i - 1]), other.node_rank(graph.order.nodes[i]));
  EXPECT_GT(other.calc_work(), some.pattern.calc_work());
  EXPECT_EQ(other.usual_work(), other.calc_work());
  graph.order.work = some.pattern.usual_work();  // found for a better one
  other.analyze(graph);
  EXPECT_EQ(other.usual_work(), some.pattern.calc_work());
}

}  // namespace
}  // namespace iota::solver
