// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_pattern.h"

#include "solver/sparse/pattern_builder.h"

#include <algorithm>
#include <stdexcept>

namespace iota::solver {

void BlockPattern::analyze(CouplingGraph& graph) {
  *this = {};
  PatternBuilder(*this, graph).analyze();
  analyzed_fill_ = fill();
}

bool BlockPattern::follow(CouplingGraph& graph, const GraphChange& change) {
  constexpr std::uint32_t always_fine = 1024;  // values: not worth an analysis
  PatternBuilder(*this, graph).follow(change);
  return fill() <= 2 * analyzed_fill_ + always_fine;
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

// Rows that stand by themselves come right after one of the constraint's nodes, so they are in that node's front.
std::uint32_t BlockPattern::find_home(std::span<const std::uint32_t> nodes, std::uint32_t unknown) const {
  for (const std::uint32_t node : nodes)
    if (vertices_[node_vertex_[node]].holds(unknown)) return node_vertex_[node];
  for (const std::uint32_t node : nodes) {
    const Vertex& v = vertices_[node_vertex_[node]];
    for (const Entry& e : entries().subspan(v.first_entry, v.entry_count))
      if (e.unknown == unknown) return e.vertex;
  }
  throw std::logic_error("rows without a home");  // ours: nothing that a user can do
}

BlockPattern::ConstraintSlot BlockPattern::constraint_slot(std::span<const std::uint32_t> nodes,
                                                           std::uint32_t unknown) const {
  const std::uint32_t home = find_home(nodes, unknown);
  const Vertex& vertex = vertices_[home];
  const std::uint8_t pivot = vertex.pivot;
  const auto row = static_cast<std::uint8_t>(unknown - vertex.unknown);
  ConstraintSlot slot;
  slot.unknown = unknown;
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

}  // namespace iota::solver
