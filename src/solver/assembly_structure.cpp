// SPDX-License-Identifier: Apache-2.0
// Where things lie in the matrix: set by an analysis, or followed through a small change of the structure.
#include "solver/assembly.h"

#include "base/slack.h"

#include <algorithm>

namespace iota::solver {

template <class C>
void Assembly::set_slots(ConstraintPool<C>& pool, std::size_t item, const BlockPattern::ConstraintSlot& where) const {
  auto& slots = pool.slots[item];
  slots.unknown = where.unknown, slots.diagonal = where.diagonal, slots.stride = where.stride;
  std::copy_n(where.gradients.begin(), C::max_nodes, slots.gradients.begin());
  if constexpr (C::has_curvature)
    for (int a = 0, pair = 0; a < pool.items[item].node_count(); ++a)
      for (int b = a + 1; b < pool.items[item].node_count(); ++b, ++pair)
        slots.pairs[pair] = pattern_.pair_slot(pool.items[item].nodes[a], pool.items[item].nodes[b]);
}

template <class F>
void Assembly::set_slots(ForcePool<F>& pool, std::size_t item) const {
  const ForceArm& arm = pool.items[item].arm;
  for (std::uint32_t a = 0, pair = 0; a < arm.count; ++a)
    for (std::uint32_t b = a + 1; b < arm.count; ++b, ++pair)
      pool.slots[item].pairs[pair] = pattern_.pair_slot(arm.nodes[a], arm.nodes[b]);
}

namespace {

CouplingGraph graph_of(const Problem& problem) {
  CouplingGraph graph;
  graph.node_count = static_cast<std::uint32_t>(problem.size());
  graph.couplings.reserve(problem.mass_couplings.size());
  std::size_t constraints = 0;
  problem.for_each_constraint_pool([&](const auto& pool) { constraints += pool.items.size(); });
  graph.constraints.reserve(constraints);
  for (const auto& c : problem.mass_couplings) graph.couplings.push_back({c.a, c.b});
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      for (std::uint32_t i = 0; i < f.arm.count; ++i)
        for (std::uint32_t j = i + 1; j < f.arm.count; ++j) graph.couplings.push_back({f.arm.nodes[i], f.arm.nodes[j]});
  });
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (const C& c : pool.items) {
      auto& added = graph.constraints.emplace_back();
      added.rows = C::rows;
      added.node_count = static_cast<std::uint8_t>(c.node_count());
      for (int i = 0; i < c.node_count(); ++i) added.nodes[i] = c.nodes[i];
      if constexpr (GeneralConstraint<C>) {
        added.apart = true;
        added.first_side = static_cast<std::uint8_t>(c.first_side);
      }
    }
  });
  return graph;
}

/// Of what bodies are made of; joints and curves have lengths of their own.
double mean_reference_length(const Problem& problem) {
  double sum = 0;
  std::size_t count = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if constexpr (!GeneralConstraint<C>) {
      for (const C& c : pool.items) sum += c.reference_length();
      count += pool.items.size();
    }
  });
  return count ? sum / static_cast<double>(count) : 1;
}

}  // namespace

void Assembly::compile(Problem& problem) {
  reference_length_ = mean_reference_length(problem);
  pattern_.analyze(graph_of(problem));
  factor_.reset(pattern_);

  for (auto& c : problem.mass_couplings) c.slot = pattern_.pair_slot(c.a, c.b);
  std::size_t index = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    pool.multipliers.resize(pool.items.size() * C::rows, 0.0);
    pool.offsets.clear();
    if (pool.has_laws()) pool.laws.resize(pool.multipliers.size());
    pool.states.assign(pool.laws.size(), {});
    pool.slots.assign(pool.items.size(), {});
    for (std::size_t i = 0; i < pool.items.size(); ++i) set_slots(pool, i, pattern_.constraint_slot(index++));
  });
  problem.for_each_force_pool([&](auto& pool) {
    pool.slots.assign(pool.items.size(), {});
    for (std::size_t i = 0; i < pool.items.size(); ++i) set_slots(pool, i);
  });
  pattern_.forget_slots();
  set_node_places(problem);
}

void Assembly::set_node_places(const Problem& problem) {
  const auto n = static_cast<std::uint32_t>(problem.size());
  const auto make_room = [](std::size_t size, auto&... lists) { (resize_with_slack(lists, size), ...); };
  make_room(n, node_unknown_, node_diagonal_, node_stride_);
  for (std::uint32_t i = 0; i < n; ++i) {
    node_unknown_[i] = pattern_.node_unknown(i);
    node_diagonal_[i] = pattern_.node_diagonal(i);
    node_stride_[i] = pattern_.node_stride(i);
  }
  make_room(pattern_.unknown_count(), unknowns_);
}

void Assembly::relink(Problem& problem, std::span<const std::array<std::uint32_t, 2>> added,
                      std::span<const std::uint32_t> removed, std::span<const std::uint32_t> touched) {
  const bool followed = try_relink(problem, added, removed, touched);
  problem.remove_nodes(removed);
  if (!followed) return compile(problem);
  pattern_.renumber(removed);
  factor_.grow();
  set_node_places(problem);
}

bool Assembly::try_relink(Problem& problem, std::span<const std::array<std::uint32_t, 2>> added,
                          std::span<const std::uint32_t> removed, std::span<const std::uint32_t> touched) {
  GraphChange change;
  change.added.assign(added.begin(), added.end());
  change.removed.assign(removed.begin(), removed.end());
  change.touched.assign(touched.begin(), touched.end());

  // Rows of bodies on the touched nodes and on their neighbors may find another home; nothing else may be there.
  std::vector<std::uint8_t> near(problem.size(), 0);
  for (const std::uint32_t node : touched) near[node] = 1;
  auto& distances = std::get<ConstraintPool<DistanceConstraint>>(problem.constraints);
  std::vector<std::uint32_t> neighbors;
  for (const DistanceConstraint& c : distances.items)
    if (near[c.nodes[0]] || near[c.nodes[1]]) neighbors.insert(neighbors.end(), c.nodes.begin(), c.nodes.end());
  for (const std::uint32_t node : neighbors) near[node] = 1;
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < distances.items.size(); ++i) {
    const auto& nodes = distances.items[i].nodes;
    if (!near[nodes[0]] && !near[nodes[1]]) continue;
    change.constraints.push_back({nodes, distances.slots[i].unknown});
    items.push_back(i);
  }
  bool strangers = false;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if constexpr (!std::is_same_v<C, DistanceConstraint>)
      for (const C& c : pool.items)
        for (int i = 0; i < c.node_count(); ++i) strangers = strangers || near[c.nodes[i]];
  });
  if (strangers) return false;

  change.neighbors = [&](std::uint32_t node, std::vector<std::uint32_t>& with) {
    for (const auto& c : problem.mass_couplings)
      if (c.a == node || c.b == node) with.push_back(c.a == node ? c.b : c.a);
    const auto add_all = [&](const auto& nodes, int count) {
      if (std::find(nodes.begin(), nodes.begin() + count, node) == nodes.begin() + count) return;
      for (int i = 0; i < count; ++i)
        if (nodes[i] != node) with.push_back(nodes[i]);
    };
    problem.for_each_constraint_pool([&](const auto& pool) {
      for (const auto& c : pool.items) add_all(c.nodes, c.node_count());
    });
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& f : pool.items) add_all(f.arm.nodes, static_cast<int>(f.arm.count));
    });
  };
  if (!pattern_.adapt(change)) return false;

  for (std::size_t i = 0; i < items.size(); ++i) set_slots(distances, items[i], pattern_.adapted_slot(i));
  const auto moved = pattern_.moved();
  for (auto& c : problem.mass_couplings)
    if (moved[c.a] || moved[c.b] || near[c.a] || near[c.b]) c.slot = pattern_.pair_slot(c.a, c.b);
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const auto begin = pool.items[k].nodes.begin(), end = begin + pool.items[k].node_count();
      if (std::none_of(begin, end, [&](std::uint32_t n) { return moved[n] && !near[n]; })) continue;
      if (std::is_same_v<C, DistanceConstraint> && std::any_of(begin, end, [&](std::uint32_t n) { return near[n]; }))
        continue;  // done already
      set_slots(pool, k, pattern_.find_slot({begin, end}, pool.slots[k].unknown));
    }
  });
  problem.for_each_force_pool([&](auto& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) set_slots(pool, k);
  });
  return true;
}

}  // namespace iota::solver
