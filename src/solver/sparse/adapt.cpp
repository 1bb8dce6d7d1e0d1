// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_pattern.h"

#include <algorithm>
#include <queue>
#include <utility>

namespace iota::solver {

namespace {
constexpr std::uint32_t none = 0xffffffff;
constexpr int most_fronts = 32;  // beyond it a new analysis is as good
constexpr int max_rows_a_node = BlockPattern::max_pivot - 3;
}  // namespace

// A cut in a chain of 10 000 links: 0.1 ms here, 3.7 ms to build and analyze the halves. All loops over the whole are
// plain passes over arrays; everything else happens for the few vertices that change.
bool BlockPattern::adapt(const GraphChange& change) {
  if (given_up_ > (diagonal_count_ + lower_count_) / 4) return false;
  const auto old_nodes = static_cast<std::uint32_t>(node_vertex_.size());
  const auto nodes = static_cast<std::uint32_t>(old_nodes + change.added.size());

  // 1. Homes of the rows around: a row lives with the first-eliminated of its nodes. Who was home before tells the
  // unknown's place.
  std::vector<std::uint32_t> around(change.touched);  // every node whose rows may change
  const auto is_touched = [&](std::uint32_t n) {
    return std::find(change.touched.begin(), change.touched.end(), n) != change.touched.end();
  };
  for (const auto& c : change.constraints)
    if (is_touched(c.nodes[0]) || is_touched(c.nodes[1])) around.insert(around.end(), c.nodes.begin(), c.nodes.end());
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  if (around.size() > most_fronts) return false;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> old_unknowns;  // of the nodes around
  for (const std::uint32_t n : around) {
    if (n >= old_nodes) continue;
    const Vertex& v = vertices_[node_vertex_[n]];
    old_unknowns.push_back({v.unknown, v.unknown + v.pivot});
  }

  // 2. The order with new vertices behind their neighbors and without the removed ones.
  const auto old_count = static_cast<std::uint32_t>(vertices_.size());
  std::vector<std::uint32_t> now_at(old_count, 0), orphaned;  // old places; none: removed. Parents of the removed.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> insertions;  // old vertex, new node
  for (std::uint32_t i = 0; i < change.added.size(); ++i)
    insertions.push_back({node_vertex_[change.added[i][1]], old_nodes + i});
  std::sort(insertions.begin(), insertions.end());
  for (const std::uint32_t node : change.removed) {
    const Vertex& v = vertices_[node_vertex_[node]];
    now_at[node_vertex_[node]] = none;
    given_up_ += v.pivot * v.pivot;
    if (v.entry_count > 0) orphaned.push_back(entries_[v.first_entry].vertex);
  }
  node_vertex_.resize(nodes, none);
  std::vector<Vertex> order;
  order.reserve(old_count + insertions.size() + 64);
  auto next_insertion = insertions.begin();
  for (std::uint32_t v = 0; v < old_count; ++v) {
    if (now_at[v] != none) {
      now_at[v] = static_cast<std::uint32_t>(order.size());
      order.push_back(vertices_[v]);
    }
    for (; next_insertion != insertions.end() && next_insertion->first == v; ++next_insertion) {
      node_vertex_[next_insertion->second] = static_cast<std::uint32_t>(order.size());
      order.push_back({});
    }
  }
  vertices_.swap(order);
  const auto count = static_cast<std::uint32_t>(vertices_.size());
  for (std::uint32_t n = 0; n < old_nodes; ++n) node_vertex_[n] = now_at[node_vertex_[n]];

  using Queue = std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>>;
  Queue queue;  // vertices to look at, in order of elimination
  std::vector<std::uint8_t> is_queued(count, 0), is_changed(count, 0);
  const auto enqueue = [&](std::uint32_t v) {
    if (v != none && !std::exchange(is_queued[v], std::uint8_t{1})) queue.push(v);
  };
  std::vector<std::uint32_t> node_of(count, none), first_child(count, none), next_child(count, none);
  for (std::uint32_t n = 0; n < nodes; ++n)
    if (node_vertex_[n] != none) node_of[node_vertex_[n]] = n;
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vertex& vertex = vertices_[v];
    for (std::uint32_t e = vertex.first_entry; e < vertex.first_entry + vertex.entry_count; ++e) {
      entries_[e].vertex = now_at[entries_[e].vertex];
      if (entries_[e].vertex == none) enqueue(v);
    }
    if (vertex.entry_count == 0 || entries_[vertex.first_entry].vertex == none) continue;
    const std::uint32_t parent = entries_[vertex.first_entry].vertex;
    next_child[v] = std::exchange(first_child[parent], v);
  }
  for (const std::uint32_t parent : orphaned) enqueue(now_at[parent]);
  for (const std::uint32_t n : change.touched) enqueue(node_vertex_[n]);

  // 3. Rows: those of the nodes around are handed out anew.
  const auto is_around = [&](std::uint32_t n) { return std::binary_search(around.begin(), around.end(), n); };
  std::vector<std::uint8_t> rows_at(around.size(), 0), row_of(change.constraints.size(), 0);
  std::vector<std::uint32_t> home_of(change.constraints.size(), none);
  for (std::size_t i = 0; i < change.constraints.size(); ++i) {
    const auto& c = change.constraints[i];
    const auto [a, b] = c.nodes;
    home_of[i] = node_vertex_[a] < node_vertex_[b] ? a : b;
    if (is_around(home_of[i])) {
      if (std::none_of(old_unknowns.begin(), old_unknowns.end(),
                       [&](const auto& range) { return c.unknown >= range.first && c.unknown < range.second; }))
        return false;  // it would leave a row behind where nothing else changes
      std::uint8_t& rows = rows_at[std::lower_bound(around.begin(), around.end(), home_of[i]) - around.begin()];
      row_of[i] = static_cast<std::uint8_t>(3 + rows);
      if (++rows > max_rows_a_node) return false;
    } else {  // as it was: must have been at home there
      const Vertex& home = vertices_[node_vertex_[home_of[i]]];
      if (c.unknown < home.unknown || c.unknown >= home.unknown + home.pivot) return false;
      row_of[i] = static_cast<std::uint8_t>(c.unknown - home.unknown);
    }
  }
  for (std::size_t i = 0; i < around.size(); ++i) {
    const std::uint32_t v = node_vertex_[around[i]];
    if (v == none) continue;
    Vertex& vertex = vertices_[v];
    const auto pivot = static_cast<std::uint8_t>(3 + rows_at[i]);
    const bool is_new = around[i] >= old_nodes;
    if (pivot == vertex.pivot && !is_new) continue;
    if (!is_new) given_up_ += vertex.pivot * vertex.pivot;
    vertex.pivot = pivot, vertex.positives = 3;
    vertex.unknown = unknown_count_, unknown_count_ += pivot;
    is_changed[v] = 1;  // its blocks have other sizes
    enqueue(v);
  }

  // 4. Fronts, upwards from where couplings changed as long as they come out differently.
  std::vector<std::uint32_t> list, with;
  int fronts = 0;
  while (!queue.empty()) {
    const std::uint32_t v = queue.top();
    queue.pop();
    if (node_of[v] == none || ++fronts > most_fronts) return false;
    list.clear(), with.clear();
    change.neighbors(node_of[v], with);
    for (const std::uint32_t n : with)
      if (node_vertex_[n] > v) list.push_back(node_vertex_[n]);
    for (std::uint32_t child = first_child[v]; child != none; child = next_child[child]) {
      const Vertex& c = vertices_[child];
      for (std::uint32_t e = c.first_entry + 1; e < c.first_entry + c.entry_count; ++e)
        list.push_back(entries_[e].vertex);
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    Vertex& vertex = vertices_[v];
    const bool same =
        list.size() == vertex.entry_count && std::equal(list.begin(), list.end(), entries_.begin() + vertex.first_entry,
                                                        [](std::uint32_t w, const Entry& e) { return w == e.vertex; });
    if (same && !is_changed[v]) continue;
    is_changed[v] = 1;
    if (!same) {
      const std::uint32_t old_parent = vertex.entry_count > 0 ? entries_[vertex.first_entry].vertex : none;
      const std::uint32_t parent = list.empty() ? none : list[0];
      enqueue(old_parent), enqueue(parent);
      if (parent != old_parent) {
        if (old_parent != none) {
          std::uint32_t* link = &first_child[old_parent];
          while (*link != v) link = &next_child[*link];
          *link = next_child[v];
        }
        if (parent != none) next_child[v] = std::exchange(first_child[parent], v);
      }
    }
    for (std::uint32_t e = vertex.first_entry; e < vertex.first_entry + vertex.entry_count; ++e)
      given_up_ += entries_[e].width * vertex.pivot;
    vertex.first_entry = static_cast<std::uint32_t>(entries_.size());
    vertex.entry_count = static_cast<std::uint32_t>(list.size());
    vertex.diagonal = diagonal_count_;
    diagonal_count_ += vertex.pivot * vertex.pivot;
    for (const std::uint32_t w : list) {
      if (node_of[w] == none) return false;
      entries_.push_back({w, lower_count_, vertices_[w].unknown, 3});
      lower_count_ += 3 * vertex.pivot;
    }
    widest_front_ = std::max(widest_front_, 3 * vertex.entry_count);
  }

  // 5. Who adds to a vertex that moved has new targets.
  for (std::uint32_t v = 0; v < count; ++v) {
    Vertex& vertex = vertices_[v];
    bool retarget = is_changed[v];
    for (std::uint32_t e = vertex.first_entry; e < vertex.first_entry + vertex.entry_count; ++e) {
      Entry& entry = entries_[e];
      if (!is_changed[entry.vertex]) continue;
      if (entry.width != 3) return false;  // rows from elsewhere reach in there: they would have to move along
      entry.unknown = vertices_[entry.vertex].unknown;
      retarget = true;
    }
    if (!retarget) continue;
    if (is_changed[v]) vertex.first_pair = static_cast<std::uint32_t>(pair_targets_.size());
    set_targets(vertex);
  }

  moved_.assign(nodes, 0);
  for (std::uint32_t n = 0; n < nodes; ++n) moved_[n] = node_vertex_[n] != none && is_changed[node_vertex_[n]];
  constraint_slots_.clear();
  for (std::size_t i = 0; i < change.constraints.size(); ++i)
    constraint_slots_.push_back(calc_slot(change.constraints[i].nodes, node_vertex_[home_of[i]], row_of[i]));
  return true;
}

BlockPattern::ConstraintSlot BlockPattern::find_slot(std::span<const std::uint32_t> nodes,
                                                     std::uint32_t unknown) const {
  const auto holds = [&](const Vertex& v) { return unknown >= v.unknown && unknown < v.unknown + v.pivot; };
  std::uint32_t home = none;
  for (const std::uint32_t node : nodes)
    if (holds(vertices_[node_vertex_[node]])) home = node_vertex_[node];
  if (home == none)  // rows with a vertex of their own
    home = static_cast<std::uint32_t>(std::find_if(vertices_.begin(), vertices_.end(), holds) - vertices_.begin());
  return calc_slot(nodes, home, static_cast<std::uint8_t>(unknown - vertices_[home].unknown));
}

void BlockPattern::renumber(std::span<const std::uint32_t> removed) {
  std::vector<std::uint32_t> highest_first(removed.begin(), removed.end());
  std::sort(highest_first.begin(), highest_first.end(), std::greater<>());
  for (const std::uint32_t node : highest_first) {
    node_vertex_[node] = node_vertex_.back();
    node_vertex_.pop_back();
  }
}

}  // namespace iota::solver
