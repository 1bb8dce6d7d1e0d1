// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_pattern.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace iota::solver {

void BlockPattern::analyze(const CouplingGraph& graph) {
  constexpr int max_rows_a_node = max_pivot - 3;
  const std::uint32_t n = graph.node_count;

  // 1. Order the nodes; a constraint makes a clique of its nodes, as the multipliers are eliminated among them.
  std::vector<std::array<std::uint32_t, 2>> edges(graph.couplings);
  for (const auto& c : graph.constraints)
    for (int i = 0; i < c.node_count; ++i)
      for (int j = i + 1; j < c.node_count; ++j) edges.push_back({c.nodes[i], c.nodes[j]});
  const std::vector<std::uint32_t> order = minimum_degree_order(n, edges);
  std::vector<std::uint32_t> rank(n);
  for (std::uint32_t i = 0; i < n; ++i) rank[order[i]] = i;

  // 2. Give each constraint a home: the first-eliminated of its nodes that has room, widest constraints first.
  struct Home {
    bool own = false;
    std::uint32_t node = 0;  // own: the one that it follows
    std::uint8_t row = 3;
  };
  std::vector<Home> homes(graph.constraints.size());
  std::vector<std::uint8_t> rows_at(n, 0);
  std::vector<std::vector<std::uint32_t>> own_after(n);
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) { return rank[a] < rank[b]; };
  const auto put_after = [&](std::uint32_t c, std::uint32_t node) {
    homes[c] = {true, node, 0};
    own_after[node].push_back(c);
  };
  for (const std::uint8_t rows : {std::uint8_t{3}, std::uint8_t{2}, std::uint8_t{1}}) {
    for (std::uint32_t c = 0; c < graph.constraints.size(); ++c) {
      const auto& constraint = graph.constraints[c];
      if (constraint.rows != rows || constraint.apart) continue;
      auto nodes = constraint.nodes;
      const auto begin = nodes.begin(), end = begin + constraint.node_count;
      std::sort(begin, end, by_rank);
      const auto home =
          std::find_if(begin, end, [&](std::uint32_t node) { return rows_at[node] + rows <= max_rows_a_node; });
      if (home == end) {
        put_after(c, end[-1]);
        continue;
      }
      homes[c] = {false, *home, static_cast<std::uint8_t>(3 + rows_at[*home])};
      rows_at[*home] = static_cast<std::uint8_t>(rows_at[*home] + rows);
    }
  }
  for (std::uint32_t c = 0; c < graph.constraints.size(); ++c) {
    const auto& constraint = graph.constraints[c];
    if (!constraint.apart) continue;
    const auto begin = constraint.nodes.begin(), middle = begin + constraint.first_side,
               end = begin + constraint.node_count;
    std::uint32_t node = *std::max_element(begin, end, by_rank);
    // A side that its own rows hold fast (nails) would leave no pivot.
    const auto try_side = [&](auto from, auto to) {
      if (std::all_of(from, to, [&](std::uint32_t i) { return rows_at[i] == max_rows_a_node; })) return;
      node = std::min(node, *std::max_element(from, to, by_rank), by_rank);
    };
    if (middle != begin) try_side(begin, middle), try_side(middle, end);
    put_after(c, node);
  }

  // 3. Vertices in order of elimination.
  vertices_.clear();
  vertices_.reserve(n);
  node_vertex_.assign(n, 0);
  std::vector<std::uint32_t> own_vertex(graph.constraints.size(), 0);
  diagonal_count_ = lower_count_ = unknown_count_ = widest_front_ = 0;
  const auto add_vertex = [&](std::uint8_t pivot, std::uint8_t positives) {
    vertices_.push_back({.pivot = pivot, .positives = positives, .unknown = unknown_count_});
    unknown_count_ += pivot;
    return static_cast<std::uint32_t>(vertices_.size() - 1);
  };
  for (const std::uint32_t node : order) {
    node_vertex_[node] = add_vertex(static_cast<std::uint8_t>(3 + rows_at[node]), 3);
    for (const std::uint32_t c : own_after[node]) own_vertex[c] = add_vertex(graph.constraints[c].rows, 0);
  }

  // 4. Structure of each front: own couplings and what the children leave behind. A later vertex takes part with its
  // node's three unknowns, or with as many of its rows too as reach here.
  const std::uint32_t vertex_count = static_cast<std::uint32_t>(vertices_.size());
  struct Coupling {
    std::uint32_t first, later;
    std::uint8_t width;
  };
  std::vector<Coupling> couplings;
  couplings.reserve(edges.size());
  const auto couple = [&](std::uint32_t a, std::uint32_t b, std::uint8_t width) {
    if (a != b) couplings.push_back({std::min(a, b), std::max(a, b), width});
  };
  for (auto [a, b] : edges) couple(node_vertex_[a], node_vertex_[b], 3);
  for (std::uint32_t c = 0; c < graph.constraints.size(); ++c) {
    const auto& constraint = graph.constraints[c];
    const std::uint32_t home = homes[c].own ? own_vertex[c] : node_vertex_[homes[c].node];
    for (int i = 0; i < constraint.node_count; ++i) {
      const std::uint32_t node = node_vertex_[constraint.nodes[i]];
      if (node < home)
        couple(node, home, static_cast<std::uint8_t>(homes[c].row + constraint.rows));
      else if (homes[c].own)
        couple(home, node, 3);
    }
  }
  std::vector<std::uint32_t> first_coupling(vertex_count + 1, 0), sorted(couplings.size());
  for (const Coupling& c : couplings) ++first_coupling[c.first + 1];
  for (std::uint32_t v = 0; v < vertex_count; ++v) first_coupling[v + 1] += first_coupling[v];
  {
    std::vector<std::uint32_t> cursor(first_coupling.begin(), first_coupling.end() - 1);
    for (std::uint32_t i = 0; i < couplings.size(); ++i) sorted[cursor[couplings[i].first]++] = i;
  }
  constexpr std::uint32_t no_vertex = 0xffffffff;
  std::vector<std::uint32_t> first_child(vertex_count, no_vertex), next_child(vertex_count, no_vertex);
  std::vector<std::uint8_t> width_of(vertex_count, 0);
  std::vector<std::uint32_t> list;
  entries_.clear(), entries_.reserve(n);
  pair_targets_.clear(), pair_targets_.reserve(n);
  given_up_ = 0;
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    list.clear();
    const auto add = [&](std::uint32_t later, std::uint8_t width) {
      if (width_of[later] == 0) list.push_back(later);
      width_of[later] = std::max(width_of[later], width);
    };
    for (std::uint32_t i = first_coupling[v]; i < first_coupling[v + 1]; ++i)
      add(couplings[sorted[i]].later, couplings[sorted[i]].width);
    for (std::uint32_t child = first_child[v]; child != no_vertex; child = next_child[child]) {
      const Vertex& c = vertices_[child];
      for (std::uint32_t e = c.first_entry + 1; e < c.first_entry + c.entry_count; ++e)
        add(entries_[e].vertex, entries_[e].width);
    }
    std::sort(list.begin(), list.end());
    Vertex& vertex = vertices_[v];
    vertex.first_entry = static_cast<std::uint32_t>(entries_.size());
    vertex.entry_count = static_cast<std::uint32_t>(list.size());
    vertex.diagonal = diagonal_count_;
    diagonal_count_ += vertex.pivot * vertex.pivot;
    std::uint32_t front = 0;
    for (const std::uint32_t w : list) {
      const std::uint8_t width = width_of[w];
      width_of[w] = 0;
      entries_.push_back({w, lower_count_, vertices_[w].unknown, width});
      lower_count_ += width * vertex.pivot;
      front += width;
    }
    widest_front_ = std::max(widest_front_, front);
    if (!list.empty()) next_child[v] = std::exchange(first_child[list[0]], v);
  }

  // 5. Where each pair of entries of a front adds its product.
  for (Vertex& vertex : vertices_) {
    vertex.first_pair = static_cast<std::uint32_t>(pair_targets_.size());
    set_targets(vertex);
  }

  // 6. Where each constraint writes its gradients.
  constraint_slots_.clear();
  for (std::uint32_t c = 0; c < graph.constraints.size(); ++c) {
    const auto& constraint = graph.constraints[c];
    const std::uint32_t home = homes[c].own ? own_vertex[c] : node_vertex_[homes[c].node];
    constraint_slots_.push_back(calc_slot({constraint.nodes.data(), constraint.node_count}, home, homes[c].row));
  }
}

void BlockPattern::set_targets(const Vertex& vertex) {
  std::size_t at = vertex.first_pair;
  pair_targets_.resize(
      std::max<std::size_t>(pair_targets_.size(), at + std::size_t{vertex.entry_count} * (vertex.entry_count + 1) / 2));
  for (std::uint32_t a = 0; a < vertex.entry_count; ++a) {
    const std::uint32_t va = entries_[vertex.first_entry + a].vertex;
    pair_targets_[at++] = vertices_[va].diagonal;
    for (std::uint32_t b = a + 1; b < vertex.entry_count; ++b)
      pair_targets_[at++] = entries_[find_entry(va, entries_[vertex.first_entry + b].vertex)].offset;
  }
}

BlockPattern::ConstraintSlot BlockPattern::calc_slot(std::span<const std::uint32_t> nodes, std::uint32_t home,
                                                     std::uint8_t row) const {
  const Vertex& vertex = vertices_[home];
  const std::uint8_t pivot = vertex.pivot;
  ConstraintSlot slot;
  slot.unknown = vertex.unknown + row;
  slot.diagonal = vertex.diagonal + row * pivot + row;
  slot.stride = pivot;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::uint32_t node = node_vertex_[nodes[i]];
    GradientSlot& g = slot.gradients[i];
    if (node == home) {
      g = {vertex.diagonal + row * pivot, pivot, 1, static_cast<std::int8_t>(row - row * pivot), true, true};
    } else if (node > home) {
      g = {entries_[find_entry(home, node)].offset + row, 1, pivot, 0, false, false};
    } else {
      const std::uint8_t node_pivot = vertices_[node].pivot;
      g = {entries_[find_entry(node, home)].offset + row * node_pivot, node_pivot, 1, 0, false, true};
    }
  }
  return slot;
}

std::uint32_t BlockPattern::find_entry(std::uint32_t vertex, std::uint32_t later_vertex) const {
  const auto begin = entries_.begin() + vertices_[vertex].first_entry;
  const auto end = begin + vertices_[vertex].entry_count;
  const auto found =
      std::lower_bound(begin, end, later_vertex, [](const Entry& e, std::uint32_t v) { return e.vertex < v; });
  return static_cast<std::uint32_t>(found - entries_.begin());
}

BlockPattern::PairSlot BlockPattern::pair_slot(std::uint32_t a, std::uint32_t b) const {
  if (a == b) throw std::logic_error("a node does not couple with itself");  // ours: nothing that a user can do
  const std::uint32_t va = node_vertex_[a], vb = node_vertex_[b];
  const bool a_first = va < vb;
  const std::uint32_t first = a_first ? va : vb, later = a_first ? vb : va;
  return {entries_[find_entry(first, later)].offset, vertices_[first].pivot, a_first};
}

}  // namespace iota::solver
