// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/pattern_builder.h"

#include "base/slack.h"

#include <algorithm>
#include <numeric>

namespace iota::solver {

void PatternBuilder::analyze() {
  is_touched_.assign(graph_.node_count, 1);
  is_listed_.assign(graph_.node_count, 1);
  rows_at_.assign(graph_.node_count, 0);
  homeless_.resize(graph_.constraints.size());
  std::iota(homeless_.begin(), homeless_.end(), 0u);
  order_all_nodes();
  find_homes();
  make_vertices();
  make_fronts();
  set_targets();
}

void PatternBuilder::follow(const GraphChange& change) {
  constexpr std::size_t usual_growth = 64;
  reserve_with_slack(pattern_.entries_, pattern_.entries_.size() + usual_growth);
  reserve_with_slack(pattern_.pair_targets_, pattern_.pair_targets_.size() + usual_growth);
  take_rows_off_touched_nodes(change);
  insert_nodes(change);
  find_homes();
  make_vertices();
  make_fronts();
  set_targets();
  note_moves();
  renumber_nodes(change);
}

// --- 1. the order of the nodes -----------------------------------------------------------------------------------------

// A constraint makes a clique of its nodes, as its multipliers are eliminated among them.
void PatternBuilder::order_all_nodes() {
  std::vector<std::array<std::uint32_t, 2>> edges(graph_.couplings);
  for (const auto& c : graph_.constraints)
    for (auto nodes = graph_.nodes_of(c); !nodes.empty(); nodes = nodes.subspan(1))
      for (const std::uint32_t other : nodes.subspan(1)) edges.push_back({nodes[0], other});
  node_order_ = elimination_order(graph_.node_count, edges, graph_.places);
  rank_.resize(graph_.node_count);
  for (std::uint32_t i = 0; i < graph_.node_count; ++i) rank_[node_order_[i]] = i;
}

// The old order, without the removed nodes and with each new one behind the node beside it.
void PatternBuilder::insert_nodes(const GraphChange& change) {
  const auto old_nodes = static_cast<std::uint32_t>(pattern_.node_vertex_.size());
  std::vector<std::uint32_t> anchors;  // old vertices: of each new node
  std::vector<std::pair<std::uint32_t, std::uint32_t>> insertions;
  for (const auto& [node, beside] : change.added) {
    anchors.push_back(beside < old_nodes ? pattern_.node_vertex_[beside] : anchors[beside - old_nodes]);
    insertions.push_back({anchors.back(), node});
  }
  std::sort(insertions.begin(), insertions.end());

  std::vector<std::uint32_t> node_at(pattern_.vertices_.size(), none);
  for (std::uint32_t node = 0; node < old_nodes; ++node) node_at[pattern_.node_vertex_[node]] = node;
  node_order_.reserve(graph_.node_count);
  auto next = insertions.begin();
  for (std::uint32_t v = 0; v < node_at.size(); ++v) {
    if (node_at[v] != none && !is_gone_[v]) node_order_.push_back(node_at[v]);
    for (; next != insertions.end() && next->first == v; ++next) node_order_.push_back(next->second);
  }
  rank_.assign(graph_.node_count, none);
  for (std::uint32_t i = 0; i < node_order_.size(); ++i) rank_[node_order_[i]] = i;
}

// --- 2. homes ----------------------------------------------------------------------------------------------------------

// The rows of touched nodes look for a home again, unless they are at home in a node that is not touched.
void PatternBuilder::take_rows_off_touched_nodes(const GraphChange& change) {
  const auto old_nodes = static_cast<std::uint32_t>(pattern_.node_vertex_.size());
  is_touched_.assign(graph_.node_count, 0);
  for (const std::uint32_t node : change.touched) is_touched_[node] = 1;
  is_listed_ = is_touched_;
  rows_at_.assign(graph_.node_count, 0);
  for (std::uint32_t node = 0; node < old_nodes; ++node)
    if (!is_touched_[node]) rows_at_[node] = static_cast<std::uint8_t>(pattern_.node_stride(node) - 3);

  is_gone_.assign(pattern_.vertices_.size(), 0);
  for (const std::uint32_t node : change.removed) is_gone_[pattern_.node_vertex_[node]] = 1;
  list_rows_by_themselves();
  for (const std::uint32_t unknown : change.removed_rows)
    if (const std::uint32_t v = rows_by_themselves_at(unknown); v != none) is_gone_[v] = 1;

  for (std::uint32_t i = 0; i < graph_.constraints.size(); ++i) {
    const auto& c = graph_.constraints[i];
    const auto nodes = graph_.nodes_of(c);
    const auto begin = nodes.begin(), end = nodes.end();
    if (std::none_of(begin, end, [&](std::uint32_t node) { return is_touched_[node]; })) continue;
    if (c.unknown != CouplingGraph::no_unknown) {
      const auto home = std::find_if(begin, end, [&](std::uint32_t node) {
        return node < old_nodes && pattern_.vertices_[pattern_.node_vertex_[node]].holds(c.unknown);
      });
      if (home == end)
        is_gone_[rows_by_themselves_at(c.unknown)] = 1;
      else if (!is_touched_[*home])
        continue;
    }
    homeless_.push_back(i);
    for (auto node = begin; node != end; ++node) is_listed_[*node] = 1;
  }
}

// Each constraint lives with the first-eliminated of its nodes that has room, the widest constraints first.
void PatternBuilder::find_homes() {
  homes_.assign(homeless_.size(), {none, 0});
  std::vector<std::uint32_t> nodes;
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; };
  for (const std::uint8_t rows : {std::uint8_t{3}, std::uint8_t{2}, std::uint8_t{1}})
    for (std::size_t i = 0; i < homeless_.size(); ++i) {
      const auto& constraint = graph_.constraints[homeless_[i]];
      if (constraint.rows != rows || constraint.apart) continue;
      const auto given = graph_.nodes_of(constraint);
      nodes.assign(given.begin(), given.end());
      const auto begin = nodes.begin(), end = nodes.end();
      std::sort(begin, end, by_rank);
      const auto home = std::find_if(begin, end, [&](std::uint32_t node) {
        return is_touched_[node] && rows_at_[node] + rows <= max_rows_a_node;
      });
      if (home == end) {
        own_rows_.push_back({end[-1], homeless_[i]});
        continue;
      }
      homes_[i] = {*home, static_cast<std::uint8_t>(3 + rows_at_[*home])};
      rows_at_[*home] = static_cast<std::uint8_t>(rows_at_[*home] + rows);
    }
  for (const std::uint32_t c : homeless_)
    if (graph_.constraints[c].apart) own_rows_.push_back({find_node_for_rows_apart(graph_.constraints[c]), c});
  std::stable_sort(own_rows_.begin(), own_rows_.end(),
                   [&](const OwnRows& a, const OwnRows& b) { return rank_[a.node] < rank_[b.node]; });
}

// The last node of the side that is eliminated first. A side that its own rows hold fast (nails) would leave no pivot.
std::uint32_t PatternBuilder::find_node_for_rows_apart(const CouplingGraph::Constraint& c) const {
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; };
  const auto nodes = graph_.nodes_of(c);
  const auto begin = nodes.begin(), middle = begin + c.first_side, end = nodes.end();
  std::uint32_t found = *std::max_element(begin, end, by_rank);
  if (middle == begin) return found;
  const auto try_side = [&](auto from, auto to) {
    if (std::all_of(from, to, [&](std::uint32_t node) { return rows_at_[node] == max_rows_a_node; })) return;
    found = std::min(found, *std::max_element(from, to, by_rank), by_rank);
  };
  try_side(begin, middle);
  if (!c.always_behind_first_side) try_side(middle, end);
  return found;
}

// --- 3. vertices -------------------------------------------------------------------------------------------------------

// Rows by themselves stay right behind their node. A vertex that is new or has another size gets other unknowns.
void PatternBuilder::make_vertices() {
  auto& vertices = pattern_.vertices_;
  const std::vector<Vertex> old = std::exchange(vertices, {});
  const auto old_nodes = pattern_.node_vertex_.size();
  std::vector<std::uint32_t> now_at(old.size(), none);
  vertices.reserve(std::max<std::size_t>(graph_.node_count, old.size()));
  const auto add = [&](Vertex vertex, std::uint32_t node, bool is_resized, bool is_due) {
    if (is_resized) vertex.unknown = pattern_.unknown_storage_.take(vertex.pivot), vertex.diagonal = none;
    vertices.push_back(vertex);
    node_of_.push_back(node), is_moved_.push_back(is_resized), is_due_.push_back(is_due);
    return static_cast<std::uint32_t>(vertices.size() - 1);
  };
  for (std::size_t v = 0; v < old.size(); ++v)
    if (is_gone_[v]) release(old[v]);
  node_of_.reserve(vertices.capacity()), is_moved_.reserve(vertices.capacity()), is_due_.reserve(vertices.capacity());
  pattern_.node_vertex_.resize(graph_.node_count, none);
  auto own = own_rows_.begin();
  for (const std::uint32_t node : node_order_) {
    const auto pivot = static_cast<std::uint8_t>(3 + rows_at_[node]);
    const std::uint32_t before = pattern_.node_vertex_[node];
    if (node >= old_nodes) {
      pattern_.node_vertex_[node] = add({.pivot = pivot}, node, true, true);
    } else {
      Vertex vertex = old[before];
      const bool is_resized = vertex.pivot != pivot;
      if (is_resized) {
        release_values(vertex);
        pattern_.unknown_storage_.give_back(vertex.unknown, vertex.pivot);
        vertex.pivot = pivot;
      }
      pattern_.node_vertex_[node] = now_at[before] = add(vertex, node, is_resized, is_listed_[node]);
      for (std::uint32_t v = before + 1; v < old.size() && !old[v].is_node(); ++v)
        if (!is_gone_[v]) now_at[v] = add(old[v], none, false, false);
    }
    for (; own != own_rows_.end() && own->node == node; ++own) {
      auto& constraint = graph_.constraints[own->constraint];
      constraint.unknown = vertices[add({.pivot = constraint.rows, .positives = 0}, none, true, true)].unknown;
    }
  }
  for (std::size_t i = 0; i < homeless_.size(); ++i)
    if (const auto [node, row] = homes_[i]; node != none)
      graph_.constraints[homeless_[i]].unknown = pattern_.node_unknown(node) + row;
  if (!old.empty()) renumber_entries(old, now_at);
  list_rows_by_themselves();
}

void PatternBuilder::release_values(const Vertex& vertex) {
  if (vertex.diagonal == none) return;  // it has none yet
  pattern_.diagonal_storage_.give_back(vertex.diagonal, std::uint32_t{vertex.pivot} * vertex.pivot);
  if (vertex.entry_count == 0) return;
  std::uint32_t rows = 0;
  for (std::uint32_t e = 0; e < vertex.entry_count; ++e) rows += pattern_.entries_[vertex.first_entry + e].width;
  pattern_.lower_storage_.give_back(pattern_.entries_[vertex.first_entry].offset, rows * vertex.pivot);
}

void PatternBuilder::release(const Vertex& vertex) {
  release_values(vertex);
  pattern_.unknown_storage_.give_back(vertex.unknown, vertex.pivot);
  pattern_.entry_storage_.give_back(vertex.first_entry, vertex.entry_count);
  pattern_.pair_storage_.give_back(vertex.first_pair, vertex.pair_count());
}

// Fronts with a vertex that is gone are due, and so is the front to which a vertex that is gone has passed on its own.
void PatternBuilder::renumber_entries(const std::vector<Vertex>& old, const std::vector<std::uint32_t>& now_at) {
  for (std::size_t v = 0; v < old.size(); ++v)
    if (is_gone_[v] && old[v].entry_count > 0)
      if (const std::uint32_t parent = now_at[pattern_.entries_[old[v].first_entry].vertex]; parent != none)
        is_due_[parent] = 1;
  for (std::size_t v = 0; v < pattern_.vertices_.size(); ++v) {
    const Vertex& vertex = pattern_.vertices_[v];
    for (std::uint32_t e = vertex.first_entry; e < vertex.first_entry + vertex.entry_count; ++e) {
      Entry& entry = pattern_.entries_[e];
      entry.vertex = now_at[entry.vertex];
      if (entry.vertex == none) is_due_[v] = 1;
    }
  }
}

void PatternBuilder::list_rows_by_themselves() {
  own_at_.clear();
  for (std::uint32_t v = 0; v < pattern_.vertices_.size(); ++v)
    if (!pattern_.vertices_[v].is_node()) own_at_.push_back({pattern_.vertices_[v].unknown, v});
  std::sort(own_at_.begin(), own_at_.end());
}

std::uint32_t PatternBuilder::rows_by_themselves_at(std::uint32_t unknown) const {
  const auto found = std::lower_bound(own_at_.begin(), own_at_.end(), std::pair{unknown, 0u});
  return found != own_at_.end() && found->first == unknown ? found->second : none;
}

// --- 4. fronts ---------------------------------------------------------------------------------------------------------

// A front is what a vertex couples with by itself and what its children leave behind. Where it comes out as before,
// nothing further up depends on the change.
void PatternBuilder::make_fronts() {
  const auto count = static_cast<std::uint32_t>(pattern_.vertices_.size());
  first_child_.assign(count, none), next_child_.assign(count, none);
  width_.assign(count, 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vertex& vertex = pattern_.vertices_[v];
    const std::uint32_t parent = vertex.entry_count > 0 ? pattern_.entries_[vertex.first_entry].vertex : none;
    if (parent != none) next_child_[v] = std::exchange(first_child_[parent], v);
  }
  list_couplings();
  for (std::uint32_t v = 0; v < count; ++v)
    if (is_due_[v]) make_front(v);
}

// A later vertex takes part with its node's three unknowns, or with as many of its rows too as reach the earlier one.
void PatternBuilder::list_couplings() {
  const auto count = pattern_.vertices_.size();
  std::vector<std::pair<std::uint32_t, Coupling>> found;  // with the earlier vertex
  found.reserve(graph_.couplings.size());
  const auto couple = [&](std::uint32_t a, std::uint32_t b, std::uint8_t width) {
    if (a != b) found.push_back({std::min(a, b), {std::max(a, b), width}});
  };
  const auto vertex_of = [&](std::uint32_t node) { return pattern_.node_vertex_[node]; };
  is_known_.assign(count, 0);
  for (std::size_t v = 0; v < count; ++v) is_known_[v] = node_of_[v] != none && is_listed_[node_of_[v]];

  for (const auto [a, b] : graph_.couplings)
    if (is_listed_[a] || is_listed_[b]) couple(vertex_of(a), vertex_of(b), 3);
  for (const auto& c : graph_.constraints) {
    const auto nodes = graph_.nodes_of(c);
    const auto begin = nodes.begin(), end = nodes.end();
    if (std::none_of(begin, end, [&](std::uint32_t node) { return is_listed_[node]; })) continue;
    const std::uint32_t home = home_of(c);
    const auto width = static_cast<std::uint8_t>(c.unknown - pattern_.vertices_[home].unknown + c.rows);
    const bool by_itself = node_of_[home] == none;
    if (by_itself) is_known_[home] = 1;
    for (auto node = begin; node != end; ++node) {
      const std::uint32_t v = vertex_of(*node);
      for (auto other = node + 1; other != end; ++other) couple(v, vertex_of(*other), 3);
      if (v < home || by_itself) couple(v, home, v < home ? width : 3);
    }
  }
  first_coupling_.assign(count + 1, 0);
  for (const auto& [first, coupling] : found) ++first_coupling_[first + 1];
  for (std::size_t v = 0; v < count; ++v) first_coupling_[v + 1] += first_coupling_[v];
  couplings_.resize(found.size());
  std::vector<std::uint32_t> cursor(first_coupling_.begin(), first_coupling_.end() - 1);
  for (const auto& [first, coupling] : found) couplings_[cursor[first]++] = coupling;
}

std::uint32_t PatternBuilder::home_of(const CouplingGraph::Constraint& c) const {
  for (const std::uint32_t node : graph_.nodes_of(c))
    if (const std::uint32_t v = pattern_.node_vertex_[node]; pattern_.vertices_[v].holds(c.unknown)) return v;
  return rows_by_themselves_at(c.unknown);
}

void PatternBuilder::make_front(std::uint32_t v) {
  if (!is_known_[v]) {  // the change has spread beyond the touched nodes
    is_listed_.assign(graph_.node_count, 1);
    list_couplings();
  }
  collect_front(v);
  Vertex& vertex = pattern_.vertices_[v];
  const bool is_same = is_front_of(vertex);
  if (!is_same) {
    const std::uint32_t before = vertex.entry_count > 0 ? pattern_.entries_[vertex.first_entry].vertex : none;
    change_parent(v, before, front_.empty() ? none : front_.front());
  }
  if (!is_same || is_moved_[v]) store_front(vertex), is_moved_[v] = 1;
  for (const std::uint32_t later : front_) width_[later] = 0;
}

void PatternBuilder::collect_front(std::uint32_t v) {
  front_.clear();
  const auto add = [&](std::uint32_t later, std::uint8_t width) {
    if (width_[later] == 0) front_.push_back(later);
    width_[later] = std::max(width_[later], width);
  };
  for (std::uint32_t i = first_coupling_[v]; i < first_coupling_[v + 1]; ++i)
    add(couplings_[i].later, couplings_[i].width);
  for (std::uint32_t child = first_child_[v]; child != none; child = next_child_[child]) {
    const Vertex& c = pattern_.vertices_[child];
    for (std::uint32_t e = c.first_entry + 1; e < c.first_entry + c.entry_count; ++e)
      add(pattern_.entries_[e].vertex, pattern_.entries_[e].width);
  }
  std::sort(front_.begin(), front_.end());
}

bool PatternBuilder::is_front_of(const Vertex& vertex) const {
  return front_.size() == vertex.entry_count &&
         std::equal(front_.begin(), front_.end(), pattern_.entries_.begin() + vertex.first_entry,
                    [&](std::uint32_t later, const Entry& e) { return later == e.vertex && width_[later] == e.width; });
}

// Both the old and the new parent see another front.
void PatternBuilder::change_parent(std::uint32_t v, std::uint32_t before, std::uint32_t now) {
  if (before != none) is_due_[before] = 1;
  if (now != none) is_due_[now] = 1;
  if (before == now) return;
  if (before != none) {
    std::uint32_t* link = &first_child_[before];
    while (*link != v) link = &next_child_[*link];
    *link = next_child_[v];
  }
  if (now != none) next_child_[v] = std::exchange(first_child_[now], v);
}

void PatternBuilder::store_front(Vertex& vertex) {
  release_values(vertex);
  pattern_.entry_storage_.give_back(vertex.first_entry, vertex.entry_count);
  pattern_.pair_storage_.give_back(vertex.first_pair, vertex.pair_count());
  vertex.entry_count = static_cast<std::uint32_t>(front_.size());
  vertex.diagonal = pattern_.diagonal_storage_.take(std::uint32_t{vertex.pivot} * vertex.pivot);
  vertex.first_entry = pattern_.entry_storage_.take(vertex.entry_count);
  vertex.first_pair = pattern_.pair_storage_.take(vertex.pair_count());
  if (pattern_.entries_.size() < pattern_.entry_storage_.size())
    pattern_.entries_.resize(pattern_.entry_storage_.size());
  if (pattern_.pair_targets_.size() < pattern_.pair_storage_.size())
    pattern_.pair_targets_.resize(pattern_.pair_storage_.size());
  std::uint32_t rows = 0;
  for (const std::uint32_t later : front_) rows += width_[later];
  std::uint32_t offset = front_.empty() ? 0 : pattern_.lower_storage_.take(rows * vertex.pivot);
  for (std::uint32_t i = 0; i < vertex.entry_count; ++i) {
    const std::uint8_t width = width_[front_[i]];
    pattern_.entries_[vertex.first_entry + i] = {front_[i], offset, 0, width};  // its unknown: see set_targets
    offset += width * vertex.pivot;
  }
  pattern_.widest_front_ = std::max(pattern_.widest_front_, rows);
}

// --- 5. targets --------------------------------------------------------------------------------------------------------

// The product of two entries of a front goes to the diagonal block of the first one's vertex, or to the block below it.
void PatternBuilder::set_targets() {
  const auto& vertices = pattern_.vertices_;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const std::span<Entry> front(pattern_.entries_.data() + vertices[v].first_entry, vertices[v].entry_count);
    if (!is_moved_[v] && std::none_of(front.begin(), front.end(), [&](const Entry& e) { return is_moved_[e.vertex]; }))
      continue;
    for (Entry& e : front) e.unknown = vertices[e.vertex].unknown;
    if (vertices[v].is_wide()) continue;
    std::uint32_t at = vertices[v].first_pair;
    for (std::size_t a = 0; a < front.size(); ++a) {
      const std::uint32_t va = front[a].vertex;
      pattern_.pair_targets_[at++] = vertices[va].diagonal;
      for (std::size_t b = a + 1; b < front.size(); ++b)
        pattern_.pair_targets_[at++] = pattern_.entries_[pattern_.find_entry(va, front[b].vertex)].offset;
    }
  }
}

void PatternBuilder::note_moves() {
  pattern_.moved_.assign(pattern_.unknown_count(), 0);
  for (std::size_t v = 0; v < pattern_.vertices_.size(); ++v)
    if (is_moved_[v] || (node_of_[v] != none && is_touched_[node_of_[v]]))
      std::fill_n(pattern_.moved_.begin() + pattern_.vertices_[v].unknown, pattern_.vertices_[v].pivot, 1);
}

void PatternBuilder::renumber_nodes(const GraphChange& change) {
  std::vector<std::uint32_t> highest_first(change.removed);
  std::sort(highest_first.begin(), highest_first.end(), std::greater<>());
  auto& node_vertex = pattern_.node_vertex_;
  for (const std::uint32_t node : highest_first) {
    node_vertex[node] = node_vertex.back();
    node_vertex.pop_back();
  }
}

}  // namespace iota::solver
