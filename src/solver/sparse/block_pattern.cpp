// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_pattern.h"

#include "solver/sparse/pattern_builder.h"

#include <algorithm>
#include <stdexcept>

namespace iota::solver {

// It keeps the room of its lists: problems of bodies that are tied and parted are analyzed all the time.
void BlockPattern::analyze(CouplingGraph& graph) {
  const auto clear = [](auto&... lists) { (lists.clear(), ...); };
  clear(vertices_, entries_, pair_targets_, node_vertex_, panels_, panel_vertices_, panel_of_, moved_);
  clear(diagonal_storage_, lower_storage_, unknown_storage_, entry_storage_, pair_storage_);
  widest_front_ = 0, wasted_work_ = 0;
  PatternBuilder::of_thread(*this, graph).analyze();
  find_panels();
  find_leaves();
  analyzed_work_ = graph.order.work > 0 ? graph.order.work : calc_work(), analyzed_nodes_ = node_count();
}

// The multiplications of a factorization, up to a factor.
double BlockPattern::calc_work() const {
  double work = 0;
  for (const Vertex& v : vertices_) {
    double rows = v.pivot;
    for (std::uint32_t e = v.first_entry; e < v.first_entry + v.entry_count; ++e) rows += entries_[e].width;
    work += v.pivot * rows * rows;
  }
  return work;
}

double BlockPattern::usual_work() const {
  return analyzed_work_ * std::max(1.0, static_cast<double>(node_count()) / std::max(1u, analyzed_nodes_));
}

bool BlockPattern::follow(CouplingGraph& graph, const GraphChange& change) {
  return PatternBuilder::follow_part(*this, graph, change, [] {});
}

bool PatternBuilder::follow_part(BlockPattern& pattern, CouplingGraph& graph, const GraphChange& change,
                                 FunctionRef<void()> complete) {
  PatternBuilder::of_thread(pattern, graph).follow(change, complete);
  pattern.find_panels();
  pattern.find_leaves();
  // A kept order fits less and less. An analysis, with all that a problem must do then, costs about what two factorizations
  // do, in heaps, and what a thousand multiplications a node do, in chains; a step takes about four factorizations. The
  // order is made anew once it has cost as much.
  const double always_fine = 20000 + 1000.0 * pattern.node_count();  // multiplications
  const double usual = pattern.usual_work();
  const double wasted = pattern.calc_work() - usual;
  pattern.wasted_work_ = wasted > 0 ? pattern.wasted_work_ + wasted : 0;
  return pattern.wasted_work_ <= 0.5 * usual + always_fine;
}

// From the last vertex down, each joins the panel that starts at its parent in the elimination tree, if that pads its
// columns with few zeros. Zeros stay zeros, so only the time depends on the choice.
void BlockPattern::find_panels() {
  constexpr std::uint32_t fewest_padding = 8;  // always acceptable rows
  panels_.clear(), panel_vertices_.clear(), panel_of_.clear();
  if (std::none_of(vertices_.begin(), vertices_.end(), [](const Vertex& v) { return v.is_wide(); })) return;
  const auto count = static_cast<std::uint32_t>(vertices_.size());
  struct Room {
    std::vector<std::uint32_t> next, columns, below, begins, first_of_last;
  };
  thread_local Room kept;
  Room passing;
  auto& [next, columns, below, begins, first_of_last] = count <= most_kept_nodes ? kept : passing;
  next.assign(count, no_panel);  // in its panel; itself: the last
  columns.assign(count, 0), below.assign(count, 0), begins.assign(count, 1);
  for (std::uint32_t v = count; v-- > 0;) {
    const Vertex& vertex = vertices_[v];
    std::uint32_t rows = 0;
    for (const Entry& e : entries().subspan(vertex.first_entry, vertex.entry_count)) rows += e.width;
    next[v] = v, columns[v] = vertex.pivot, below[v] = rows;
    if (vertex.entry_count == 0) continue;
    const std::uint32_t parent = entries_[vertex.first_entry].vertex;
    const std::uint32_t padded = columns[parent] + below[parent];
    if (!begins[parent] || columns[parent] + vertex.pivot > Panel::most_columns) continue;
    if (padded > rows + std::max(fewest_padding, padded / 5)) continue;
    begins[parent] = 0;
    next[v] = parent, columns[v] = columns[parent] + vertex.pivot, below[v] = below[parent];
  }
  panel_of_.assign(count, no_panel);
  first_of_last.assign(count, no_panel);  // of panels with a wide vertex
  for (std::uint32_t v = 0; v < count; ++v) {
    if (!begins[v]) continue;
    bool wide = false;
    std::uint32_t last = v;
    for (;; last = next[last]) {
      wide = wide || vertices_[last].is_wide();
      if (next[last] == last) break;
    }
    if (wide) first_of_last[last] = v;
  }
  for (std::uint32_t last = 0; last < count; ++last) {
    if (first_of_last[last] == no_panel) continue;
    const std::uint32_t first = first_of_last[last];
    Panel panel{.first = static_cast<std::uint32_t>(panel_vertices_.size())};
    for (std::uint32_t v = first;; v = next[v]) {
      panel_of_[v] = static_cast<std::uint32_t>(panels_.size());
      panel_vertices_.push_back(v);
      ++panel.count;
      if (v == last) break;
    }
    panel.columns = columns[first], panel.rows = columns[first] + below[first];
    panels_.push_back(panel);
  }
}

void BlockPattern::find_leaves() {
  bool is_leaf_behind = false;
  for (std::size_t i = vertices_.size(); i-- > 0;) {
    Vertex& v = vertices_[i];
    const Entry* const entry = v.entry_count == 1 ? &entries_[v.first_entry] : nullptr;
    const bool is_leaf = entry && entry->width == 3 && (panel_of_.empty() || panel_of_[i] == no_panel);
    v.leaves = is_leaf;
    if (is_leaf && is_leaf_behind && entry->vertex != i + 1) {
      const Vertex& w = vertices_[i + 1];
      if (w.pivot == v.pivot && w.positives == v.positives) v.leaves = 2;
    }
    is_leaf_behind = is_leaf;
  }
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

bool BlockPattern::are_coupled(std::uint32_t a, std::uint32_t b) const {
  const auto [first, later] = std::minmax(node_vertex_[a], node_vertex_[b]);
  const std::uint32_t entry = find_entry(first, later);
  return entry < vertices_[first].first_entry + vertices_[first].entry_count && entries_[entry].vertex == later;
}

// Separate rows come right after one of the constraint's nodes, so that they are in that node's front, or not far before all
// of them.
std::uint32_t BlockPattern::find_home(std::span<const std::uint32_t> nodes, std::uint32_t unknown) const {
  for (const std::uint32_t node : nodes)
    if (vertices_[node_vertex_[node]].holds(unknown)) return node_vertex_[node];
  for (const std::uint32_t node : nodes) {
    const Vertex& v = vertices_[node_vertex_[node]];
    for (const Entry& e : entries().subspan(v.first_entry, v.entry_count))
      if (e.unknown == unknown) return e.vertex;
  }
  std::uint32_t v = static_cast<std::uint32_t>(vertices_.size());
  for (const std::uint32_t node : nodes) v = std::min(v, node_vertex_[node]);
  while (v-- > 0)
    if (vertices_[v].unknown == unknown) return v;
  throw std::logic_error("rows without a home");  // ours: nothing that a user can do
}

BlockPattern::ConstraintSlot BlockPattern::constraint_slot(std::span<const std::uint32_t> nodes, std::uint32_t unknown,
                                                           GradientSlot* gradients) const {
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
    GradientSlot& g = gradients[i];
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
