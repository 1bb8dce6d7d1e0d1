// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/pattern_builder.h"

#include "base/slack.h"
#include "base/sort_unique.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace iota::solver {

PatternBuilder& PatternBuilder::of_thread(BlockPattern& pattern, CouplingGraph& graph) {
  thread_local PatternBuilder builder;
  builder.begin(pattern, graph);
  return builder;
}

void PatternBuilder::begin(BlockPattern& pattern, CouplingGraph& graph) {
  pattern_ = &pattern, graph_ = &graph;
  old_nodes_ = 0, all_are_listed_ = false, next_own_rows_ = 0;
  const auto clear = [](auto&... lists) { (lists.clear(), ...); };
  clear(node_order_, is_changed_, rows_at_, is_listed_, listed_, rank_of_added_, insertions_);
  clear(homeless_, homes_, own_rows_, is_gone_, now_at_, is_due_, is_known_, is_moved_, own_at_);
}

void PatternBuilder::analyze() {
  is_changed_.assign(graph_->node_count, 1);
  is_listed_.assign(graph_->node_count, 1), all_are_listed_ = true;
  rows_at_.assign(graph_->node_count, 0);
  homeless_.resize(graph_->constraints.size());
  std::iota(homeless_.begin(), homeless_.end(), 0u);
  order_all_nodes();
  find_homes();
  make_all_vertices();
  make_fronts([] {});
  set_targets();
  end();
}

void PatternBuilder::end() {
  if (graph_->node_count > most_kept_nodes) *this = PatternBuilder();
}

void PatternBuilder::follow(const GraphChange& change, FunctionRef<void()> complete) {
  constexpr std::size_t usual_growth = 64;
  reserve_with_slack(pattern_->entries_, pattern_->entries_.size() + usual_growth);
  reserve_with_slack(pattern_->pair_targets_, pattern_->pair_targets_.size() + usual_growth);
  old_nodes_ = pattern_->node_count();
  take_rows_off_changed_nodes(change);
  find_insertions(change);
  find_homes();
  renew_vertices(change);
  make_fronts(complete);
  set_targets();
  note_moves(change);
  renumber_nodes(change);
  end();
}

// --- 1. the order of the nodes -----------------------------------------------------------------------------------------

// A constraint makes its nodes a clique, as its multipliers are eliminated among them.
void PatternBuilder::order_all_nodes() {
  if (const auto& known = graph_->order.nodes; known.size() == graph_->node_count) {
    node_order_.assign(known.begin(), known.end());
  } else {
    std::vector<std::array<std::uint32_t, 2>>& edges = edges_;
    edges.assign(graph_->couplings.begin(), graph_->couplings.end());
    for (const auto& c : graph_->constraints)
      for (auto nodes = graph_->nodes_of(c); !nodes.empty(); nodes = nodes.subspan(1))
        for (const std::uint32_t other : nodes.subspan(1)) edges.push_back({nodes[0], other});
    find_elimination_order(graph_->node_count, edges, graph_->places, node_order_);
  }
  old_nodes_ = graph_->node_count;
  pattern_->node_vertex_.resize(graph_->node_count);  // until there are vertices: places in the order
  for (std::uint32_t i = 0; i < graph_->node_count; ++i) pattern_->node_vertex_[node_order_[i]] = i;
}

// The old order stays, with each new node behind the node beside it.
void PatternBuilder::find_insertions(const GraphChange& change) {
  std::vector<std::uint32_t>& after = scratch_;  // of each new node
  after.clear();
  for (const auto& [node, beside] : change.added) {
    after.push_back(beside == GraphChange::front ? 0
                    : beside < old_nodes_        ? pattern_->node_vertex_[beside] + 1
                                                 : after[beside - old_nodes_]);
    insertions_.push_back({after.back(), node});
  }
  std::sort(insertions_.begin(), insertions_.end());
  rank_of_added_.resize(insertions_.size());
  for (std::size_t i = 0; i < insertions_.size(); ++i)
    rank_of_added_[insertions_[i].node - old_nodes_] = (std::uint64_t{insertions_[i].after} << 32) + i + 1;
}

/// A number that is higher for a node that is eliminated later.
std::uint64_t PatternBuilder::rank_of(std::uint32_t node) const {
  return node < old_nodes_ ? (std::uint64_t{pattern_->node_vertex_[node]} + 1) << 32
                           : rank_of_added_[node - old_nodes_];
}

// --- 2. homes ----------------------------------------------------------------------------------------------------------

// The rows of changed nodes get a home again, unless their home is an unchanged node.
void PatternBuilder::take_rows_off_changed_nodes(const GraphChange& change) {
  is_changed_.assign(graph_->node_count, 0), is_listed_.assign(graph_->node_count, 0);
  rows_at_.assign(graph_->node_count, 0);
  for (const std::uint32_t node : change.changed) is_changed_[node] = 1, list(node);

  is_gone_.assign(pattern_->vertices_.size(), 0);
  for (const std::uint32_t node : change.removed) is_gone_[pattern_->node_vertex_[node]] = 1;
  list_rows_by_themselves(old_nodes_);
  for (const std::uint32_t unknown : change.removed_rows)
    if (const std::uint32_t v = rows_by_themselves_at(unknown); v != none) is_gone_[v] = 1;

  for (std::uint32_t i = 0; i < graph_->constraints.size(); ++i) {
    const auto& c = graph_->constraints[i];
    const auto nodes = graph_->nodes_of(c);
    const auto begin = nodes.begin(), end = nodes.end();
    if (std::none_of(begin, end, [&](std::uint32_t node) { return is_changed_[node]; })) continue;
    if (c.unknown != CouplingGraph::no_unknown) {
      const auto home = std::find_if(begin, end, [&](std::uint32_t node) {
        return node < old_nodes_ && pattern_->vertices_[pattern_->node_vertex_[node]].holds(c.unknown);
      });
      if (home == end)
        is_gone_[rows_by_themselves_at(c.unknown)] = 1;
      else if (!is_changed_[*home])
        continue;
    }
    homeless_.push_back(i);
    for (auto node = begin; node != end; ++node) list(*node);
  }
}

void PatternBuilder::list(std::uint32_t node) {
  if (is_listed_[node]) return;
  is_listed_[node] = 1;
  listed_.push_back(node);
  if (!is_changed_[node]) rows_at_[node] = static_cast<std::uint8_t>(pattern_->node_stride(node) - 3);
}

// The home of a constraint is the first-eliminated of its nodes with room; the widest constraints come first.
void PatternBuilder::find_homes() {
  homes_.assign(homeless_.size(), {none, 0});
  std::vector<std::uint32_t>& nodes = scratch_;
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) { return rank_of(a) < rank_of(b); };
  for (const std::uint8_t rows : {std::uint8_t{3}, std::uint8_t{2}, std::uint8_t{1}})
    for (std::size_t i = 0; i < homeless_.size(); ++i) {
      const auto& constraint = graph_->constraints[homeless_[i]];
      if (constraint.rows != rows || constraint.apart) continue;
      const auto given = graph_->nodes_of(constraint);
      nodes.assign(given.begin(), given.end());
      const auto begin = nodes.begin(), end = nodes.end();
      std::sort(begin, end, by_rank);
      const auto home = std::find_if(begin, end, [&](std::uint32_t node) {
        return is_changed_[node] && rows_at_[node] + rows <= max_rows_a_node;
      });
      if (home == end) {
        give_own_rows(homeless_[i], end[-1]);
        continue;
      }
      homes_[i] = {*home, static_cast<std::uint8_t>(3 + rows_at_[*home])};
      rows_at_[*home] = static_cast<std::uint8_t>(rows_at_[*home] + rows);
    }
  for (const std::uint32_t c : homeless_)
    if (const auto& constraint = graph_->constraints[c]; constraint.before_all)
      give_own_rows(c, *std::ranges::min_element(graph_->nodes_of(constraint), by_rank), false);
    else if (constraint.apart)
      give_own_rows(c, find_node_for_rows_apart(constraint));
  std::sort(own_rows_.begin(), own_rows_.end(), [&](const OwnRows& a, const OwnRows& b) {
    return std::tuple(rank_of(a.node), a.is_behind, a.number) < std::tuple(rank_of(b.node), b.is_behind, b.number);
  });
}

// The last node of the side that is eliminated first. A side that its own rows fix (nails) would leave no pivot.
std::uint32_t PatternBuilder::find_node_for_rows_apart(const CouplingGraph::Constraint& c) const {
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) { return rank_of(a) < rank_of(b); };
  const auto nodes = graph_->nodes_of(c);
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

// A vertex that is new or has another size gets other unknowns.
std::uint32_t PatternBuilder::add_vertex(Vertex vertex, bool is_resized) {
  if (is_resized) vertex.unknown = pattern_->unknown_storage_.take(vertex.pivot), vertex.diagonal = none;
  pattern_->vertices_.push_back(vertex);
  is_moved_.push_back(is_resized), is_due_.push_back(is_resized);
  return static_cast<std::uint32_t>(pattern_->vertices_.size() - 1);
}

// Rows by themselves stay right behind their node, or before it.
void PatternBuilder::add_own_rows_of(std::uint32_t node, bool is_behind) {
  const auto is_next = [&] {
    return next_own_rows_ < own_rows_.size() && own_rows_[next_own_rows_].node == node &&
           own_rows_[next_own_rows_].is_behind == is_behind;
  };
  for (; is_next(); ++next_own_rows_) {
    auto& constraint = graph_->constraints[own_rows_[next_own_rows_].constraint];
    const std::uint32_t v = add_vertex({.pivot = constraint.rows, .positives = 0}, true);
    constraint.unknown = pattern_->vertices_[v].unknown;
  }
}

void PatternBuilder::note_homes(std::size_t nodes) {
  for (std::size_t i = 0; i < homeless_.size(); ++i)
    if (const auto [node, row] = homes_[i]; node != none)
      graph_->constraints[homeless_[i]].unknown = pattern_->node_unknown(node) + row;
  list_rows_by_themselves(nodes);
}

void PatternBuilder::make_all_vertices() {
  pattern_->vertices_.reserve(graph_->node_count);
  is_moved_.reserve(graph_->node_count), is_due_.reserve(graph_->node_count);
  for (const std::uint32_t node : node_order_) {
    const auto pivot = static_cast<std::uint8_t>(3 + rows_at_[node]);
    add_own_rows_of(node, false);
    pattern_->node_vertex_[node] = add_vertex({.pivot = pivot}, true);
    add_own_rows_of(node, true);
  }
  note_homes(graph_->node_count);
}

// Only some vertices change: what lies between them is taken over as it is.
void PatternBuilder::renew_vertices(const GraphChange& change) {
  list_changing_vertices(change);
  const std::vector<std::uint32_t>& changing = changing_;
  std::vector<std::uint32_t>& node_at = scratch_;  // of these; of nodes that may take rows
  node_at.assign(changing.size(), none);
  const auto note_node = [&](std::uint32_t node) {
    if (node >= old_nodes_) return;
    const auto at = std::lower_bound(changing.begin(), changing.end(), pattern_->node_vertex_[node]);
    node_at[static_cast<std::size_t>(at - changing.begin())] = node;
  };
  for (const std::uint32_t node : change.changed) note_node(node);
  for (const OwnRows& rows : own_rows_) note_node(rows.node);

  for (const std::uint32_t v : changing)
    if (is_gone_[v]) release(pattern_->vertices_[v]);
  auto& vertices = pattern_->vertices_;
  const std::vector<Vertex>& old = old_vertices_;
  old_vertices_.assign(vertices.begin(), vertices.end());
  vertices.clear();
  const std::size_t room = old.size() + insertions_.size() + own_rows_.size();
  reserve_with_slack(vertices, room), is_moved_.reserve(room), is_due_.reserve(room);
  now_at_.assign(old.size(), none);
  pattern_->node_vertex_.resize(graph_->node_count, none);

  std::uint32_t next = 0;  // old vertex
  const auto take_until = [&](std::uint32_t end) {
    const auto shifted = static_cast<std::uint32_t>(vertices.size());
    std::iota(now_at_.begin() + next, now_at_.begin() + end, shifted);
    vertices.insert(vertices.end(), old.begin() + next, old.begin() + end);
    is_moved_.resize(vertices.size(), 0), is_due_.resize(vertices.size(), 0);
    next = end;
  };
  auto insertion = insertions_.begin();
  const auto insert_after = [&](std::uint32_t count) {
    for (; insertion != insertions_.end() && insertion->after == count; ++insertion) {
      const auto pivot = static_cast<std::uint8_t>(3 + rows_at_[insertion->node]);
      add_own_rows_of(insertion->node, false);
      pattern_->node_vertex_[insertion->node] = add_vertex({.pivot = pivot}, true);
      add_own_rows_of(insertion->node, true);
    }
  };
  insert_after(0);
  for (std::size_t i = 0; i < changing.size(); ++i) {
    const std::uint32_t v = changing[i], node = node_at[i];
    if (v < next) continue;  // rows by themselves, which have gone with their node
    take_until(v);
    if (node != none) add_own_rows_of(node, false);
    if (is_gone_[v]) {
      ++next;
    } else if (node != none && is_changed_[node] && old[v].pivot != 3 + rows_at_[node]) {
      Vertex resized = old[v];
      release_values(resized);
      pattern_->unknown_storage_.give_back(resized.unknown, resized.pivot);
      resized.pivot = static_cast<std::uint8_t>(3 + rows_at_[node]);
      now_at_[v] = add_vertex(resized, true);
      ++next;
    } else {
      take_until(v + 1);
    }
    if (!old[v].is_node()) continue;
    for (; next < old.size() && !old[next].is_node();)
      if (is_gone_[next])
        ++next;
      else
        take_until(next + 1);
    if (node != none) add_own_rows_of(node, true);
    insert_after(v + 1);
  }
  take_until(static_cast<std::uint32_t>(old.size()));

  for (std::uint32_t node = 0; node < old_nodes_; ++node)
    pattern_->node_vertex_[node] = now_at_[pattern_->node_vertex_[node]];  // none: it is gone
  note_homes(graph_->node_count - change.removed.size());
  for (const std::uint32_t node : listed_)
    if (const std::uint32_t v = pattern_->node_vertex_[node]; v != none) is_due_[v] = 1;
  renumber_entries(old, changing);
}

// Old ones that go, that may get another size, and behind which new ones come; in order.
void PatternBuilder::list_changing_vertices(const GraphChange& change) {
  std::vector<std::uint32_t>& changing = changing_;
  changing.clear();
  const auto add_node = [&](std::uint32_t node) {
    if (node < old_nodes_) changing.push_back(pattern_->node_vertex_[node]);
  };
  for (const std::uint32_t node : change.changed) add_node(node);
  for (const std::uint32_t node : change.removed) add_node(node);
  for (const OwnRows& rows : own_rows_) add_node(rows.node);
  for (const Insertion& insertion : insertions_)
    if (insertion.after > 0) changing.push_back(insertion.after - 1);
  for (const auto& [unknown, v] : own_at_)
    if (is_gone_[v]) changing.push_back(v);
  sort_unique(changing);
}

void PatternBuilder::release_values(const Vertex& vertex) {
  if (vertex.diagonal == none) return;  // no front yet
  pattern_->diagonal_storage_.give_back(vertex.diagonal, std::uint32_t{vertex.pivot} * vertex.pivot);
  if (vertex.entry_count == 0) return;
  std::uint32_t rows = 0;
  for (std::uint32_t e = 0; e < vertex.entry_count; ++e) rows += pattern_->entries_[vertex.first_entry + e].width;
  pattern_->lower_storage_.give_back(pattern_->entries_[vertex.first_entry].offset, rows * vertex.pivot);
}

void PatternBuilder::release(const Vertex& vertex) {
  release_values(vertex);
  pattern_->unknown_storage_.give_back(vertex.unknown, vertex.pivot);
  pattern_->entry_storage_.give_back(vertex.first_entry, vertex.entry_count);
  pattern_->pair_storage_.give_back(vertex.first_pair, vertex.pair_count());
}

// Fronts with a removed vertex are due, and so is the parent front of a removed vertex.
void PatternBuilder::renumber_entries(const std::vector<Vertex>& old, std::span<const std::uint32_t> changing) {
  for (const std::uint32_t v : changing)
    if (is_gone_[v] && old[v].entry_count > 0)
      if (const std::uint32_t parent = now_at_[pattern_->entries_[old[v].first_entry].vertex]; parent != none)
        is_due_[parent] = 1;
  Entry* const entries = pattern_->entries_.data();
  const auto count = static_cast<std::uint32_t>(pattern_->vertices_.size());
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vertex& vertex = pattern_->vertices_[v];
    for (std::uint32_t e = vertex.first_entry; e < vertex.first_entry + vertex.entry_count; ++e) {
      entries[e].vertex = now_at_[entries[e].vertex];
      if (entries[e].vertex == none) is_due_[v] = 1;
    }
  }
}

void PatternBuilder::list_rows_by_themselves(std::size_t nodes) {
  own_at_.clear();
  if (pattern_->vertices_.size() == nodes) return;  // there are none
  for (std::uint32_t v = 0; v < pattern_->vertices_.size(); ++v)
    if (!pattern_->vertices_[v].is_node()) own_at_.push_back({pattern_->vertices_[v].unknown, v});
  std::sort(own_at_.begin(), own_at_.end());
}

std::uint32_t PatternBuilder::rows_by_themselves_at(std::uint32_t unknown) const {
  const auto found = std::lower_bound(own_at_.begin(), own_at_.end(), std::pair{unknown, 0u});
  return found != own_at_.end() && found->first == unknown ? found->second : none;
}

// --- 4. fronts ---------------------------------------------------------------------------------------------------------

// A front is the vertex's own couplings and those of its children's fronts. If it is unchanged, no front further up
// depends on the change.
void PatternBuilder::make_fronts(FunctionRef<void()> complete) {
  const auto count = static_cast<std::uint32_t>(pattern_->vertices_.size());
  first_child_.assign(count, none), next_child_.assign(count, none);
  width_.assign(count, 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    const Vertex& vertex = pattern_->vertices_[v];
    const std::uint32_t parent = vertex.entry_count > 0 ? pattern_->entries_[vertex.first_entry].vertex : none;
    if (parent != none) next_child_[v] = std::exchange(first_child_[parent], v);
  }
  list_couplings();
  for (std::uint32_t v = 0; v < count; ++v)
    if (is_due_[v]) make_front(v, complete);
}

// A later vertex takes part with its node's three unknowns, or also with those of its rows that reach the earlier one.
void PatternBuilder::list_couplings() {
  const auto count = pattern_->vertices_.size();
  std::vector<std::pair<std::uint32_t, Coupling>>& found = found_;  // with the earlier vertex
  found.clear();
  const auto couple = [&](std::uint32_t a, std::uint32_t b, std::uint8_t width) {
    if (a != b) found.push_back({std::min(a, b), {std::max(a, b), width}});
  };
  const auto vertex_of = [&](std::uint32_t node) { return pattern_->node_vertex_[node]; };
  is_known_.assign(count, all_are_listed_);
  for (const std::uint32_t node : listed_)
    if (const std::uint32_t v = vertex_of(node); v != none) is_known_[v] = 1;

  for (const auto [a, b] : graph_->couplings)
    if (is_listed_[a] || is_listed_[b]) couple(vertex_of(a), vertex_of(b), 3);
  for (const auto& c : graph_->constraints) {
    const auto nodes = graph_->nodes_of(c);
    const auto begin = nodes.begin(), end = nodes.end();
    if (std::none_of(begin, end, [&](std::uint32_t node) { return is_listed_[node]; })) continue;
    const std::uint32_t home = home_of(c);
    const auto width = static_cast<std::uint8_t>(c.unknown - pattern_->vertices_[home].unknown + c.rows);
    const bool by_itself = !pattern_->vertices_[home].is_node();
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
  std::vector<std::uint32_t>& cursor = scratch_;
  cursor.assign(first_coupling_.begin(), first_coupling_.end() - 1);
  for (const auto& [first, coupling] : found) couplings_[cursor[first]++] = coupling;
}

std::uint32_t PatternBuilder::home_of(const CouplingGraph::Constraint& c) const {
  for (const std::uint32_t node : graph_->nodes_of(c))
    if (const std::uint32_t v = pattern_->node_vertex_[node]; pattern_->vertices_[v].holds(c.unknown)) return v;
  return rows_by_themselves_at(c.unknown);
}

void PatternBuilder::make_front(std::uint32_t v, FunctionRef<void()> complete) {
  if (!is_known_[v]) {  // the change has spread beyond the changed nodes
    complete();
    is_listed_.assign(graph_->node_count, 1), all_are_listed_ = true;
    list_couplings();
  }
  collect_front(v);
  Vertex& vertex = pattern_->vertices_[v];
  const bool is_same = is_front_of(vertex);
  if (!is_same) {
    const std::uint32_t before = vertex.entry_count > 0 ? pattern_->entries_[vertex.first_entry].vertex : none;
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
    const Vertex& c = pattern_->vertices_[child];
    for (std::uint32_t e = c.first_entry + 1; e < c.first_entry + c.entry_count; ++e)
      add(pattern_->entries_[e].vertex, pattern_->entries_[e].width);
  }
  std::sort(front_.begin(), front_.end());
}

bool PatternBuilder::is_front_of(const Vertex& vertex) const {
  return front_.size() == vertex.entry_count &&
         std::equal(front_.begin(), front_.end(), pattern_->entries_.begin() + vertex.first_entry,
                    [&](std::uint32_t later, const Entry& e) { return later == e.vertex && width_[later] == e.width; });
}

// The fronts of the old and the new parent change.
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
  pattern_->entry_storage_.give_back(vertex.first_entry, vertex.entry_count);
  pattern_->pair_storage_.give_back(vertex.first_pair, vertex.pair_count());
  vertex.entry_count = static_cast<std::uint32_t>(front_.size());
  vertex.diagonal = pattern_->diagonal_storage_.take(std::uint32_t{vertex.pivot} * vertex.pivot);
  vertex.first_entry = pattern_->entry_storage_.take(vertex.entry_count);
  vertex.first_pair = pattern_->pair_storage_.take(vertex.pair_count());
  if (pattern_->entries_.size() < pattern_->entry_storage_.size())
    pattern_->entries_.resize(pattern_->entry_storage_.size());
  if (pattern_->pair_targets_.size() < pattern_->pair_storage_.size())
    pattern_->pair_targets_.resize(pattern_->pair_storage_.size());
  std::uint32_t rows = 0;
  for (const std::uint32_t later : front_) rows += width_[later];
  std::uint32_t offset = front_.empty() ? 0 : pattern_->lower_storage_.take(rows * vertex.pivot);
  for (std::uint32_t i = 0; i < vertex.entry_count; ++i) {
    const std::uint8_t width = width_[front_[i]];
    pattern_->entries_[vertex.first_entry + i] = {front_[i], offset, 0, width};  // its unknown: see set_targets
    offset += width * vertex.pivot;
  }
  pattern_->widest_front_ = std::max(pattern_->widest_front_, rows);
}

// --- 5. targets --------------------------------------------------------------------------------------------------------

// The product of two entries of a front goes to the diagonal block of the first one's vertex, or to the block below it.
void PatternBuilder::set_targets() {
  const auto& vertices = pattern_->vertices_;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const std::span<Entry> front(pattern_->entries_.data() + vertices[v].first_entry, vertices[v].entry_count);
    if (!is_moved_[v] && std::none_of(front.begin(), front.end(), [&](const Entry& e) { return is_moved_[e.vertex]; }))
      continue;
    for (Entry& e : front) e.unknown = vertices[e.vertex].unknown;
    if (vertices[v].is_wide()) continue;
    std::uint32_t at = vertices[v].first_pair;
    for (std::size_t a = 0; a < front.size(); ++a) {
      const Vertex& target = vertices[front[a].vertex];
      pattern_->pair_targets_[at++] = target.diagonal;
      const Entry* below = pattern_->entries_.data() + target.first_entry;
      for (std::size_t b = a + 1; b < front.size(); ++b) {
        while (below->vertex != front[b].vertex) ++below;
        pattern_->pair_targets_[at++] = below->offset;
      }
    }
  }
}

void PatternBuilder::note_moves(const GraphChange& change) {
  pattern_->moved_.assign(pattern_->unknown_count(), 0);
  const auto note = [&](const Vertex& v) { std::fill_n(pattern_->moved_.begin() + v.unknown, v.pivot, 1); };
  for (std::size_t v = 0; v < pattern_->vertices_.size(); ++v)
    if (is_moved_[v]) note(pattern_->vertices_[v]);
  for (const std::uint32_t node : change.changed)
    if (const std::uint32_t v = pattern_->node_vertex_[node]; v != none) note(pattern_->vertices_[v]);
}

void PatternBuilder::renumber_nodes(const GraphChange& change) {
  number_.set(pattern_->node_vertex_.size(), change.removed);
  number_.apply(pattern_->node_vertex_);
}

}  // namespace iota::solver
