// SPDX-License-Identifier: Apache-2.0
// Where things lie in the matrix: set by an analysis, or kept up with a change of the problem.
#include "solver/assembly.h"

#include "base/slack.h"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace iota::solver {

template <class C>
void Assembly::set_slots(ConstraintPool<C>& pool, std::size_t item, std::uint32_t unknown) const {
  auto& slots = pool.slots[item];
  const C& c = pool.items[item];
  const auto where = pattern_.constraint_slot(pool.nodes_of(c), unknown, slots.gradients.data());
  slots.unknown = where.unknown, slots.diagonal = where.diagonal, slots.stride = where.stride;
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

/// Constraints in the order of the pools and of their items, with the unknowns that they have had.
CouplingGraph graph_of(const Problem& problem) {
  CouplingGraph graph;
  graph.node_count = static_cast<std::uint32_t>(problem.size());
  graph.places = problem.position;
  graph.couplings.reserve(problem.mass_couplings.size());
  std::size_t constraints = 0;
  problem.for_each_constraint_pool([&](const auto& pool) { constraints += pool.items.size(); });
  graph.constraints.reserve(constraints);
  graph.nodes.reserve(2 * constraints);
  for (const auto& c : problem.mass_couplings) graph.couplings.push_back({c.a, c.b});
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      for (std::uint32_t i = 0; i < f.arm.count; ++i)
        for (std::uint32_t j = i + 1; j < f.arm.count; ++j) graph.couplings.push_back({f.arm.nodes[i], f.arm.nodes[j]});
  });
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      auto& added = graph.add(C::rows, pool.nodes_of(c));
      if (k < pool.slots.size()) added.unknown = pool.slots[k].unknown;
      if constexpr (GeneralConstraint<C>) {
        added.apart = true;
        added.first_side = static_cast<std::uint8_t>(c.first_side);
        added.always_behind_first_side = std::is_same_v<C, CouplingConstraint>;
      }
    }
  });
  return graph;
}

/// Of the rods that bodies are made of; joints and curves have lengths of their own. Where there are none, of the forces
/// between points; else 1 m.
double mean_reference_length(const Problem& problem) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& c : problem.pool_of<DistanceConstraint>().items) sum += c.reference_length(), ++count;
  if (count == 0)
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& f : pool.items)
        if (f.arm.is_internal()) sum += norm(f.arm.value(problem.position.data())), ++count;
    });
  return sum > 0 ? sum / static_cast<double>(count) : 1;
}

/// Rows of nails and of carried points are measured by the same length.
double set_reference_lengths(Problem& problem) {
  const double length = mean_reference_length(problem);
  for (auto& c : problem.pool_of<AffineConstraint>().items) c.reference = length;
  return length;
}

}  // namespace

void Assembly::compile(Problem& problem) {
  reference_length_ = set_reference_lengths(problem);
  CouplingGraph graph = graph_of(problem);
  pattern_.analyze(graph);
  factor_.reset(pattern_);
  problem.fit_pools();
  place_items(problem, graph, [](auto...) { return true; });
  place_nodes(problem);
  weigh(problem);
  problem.note_compiled();
}

// A row gives by its compliance times the force in it, and a light link may carry the weight of all the others: beyond a
// ratio of 1e7 the gap would show. Then forces are measured by how far they move a point against the rows that pull at it,
// not against its mass alone: between two heavy loads the balance of a light point is round-off of their tension.
void Assembly::weigh(const Problem& problem) {
  constexpr double usual = 1e7;
  double heaviest = 0, lightest = std::numeric_limits<double>::infinity();
  for (const double m : problem.mass) heaviest = std::max(heaviest, m), lightest = std::min(lightest, m);
  row_compliance_ = lightest > 0 ? std::clamp(usual * lightest / heaviest, 1e-6, 1.0) : 1;
}

void Assembly::follow(Problem& problem) {
  CouplingGraph graph = graph_of(problem);
  const bool order_suits = pattern_.follow(graph, problem.changes());
  problem.remove_nodes(problem.changes().removed);
  if (!order_suits) return compile(problem);
  reference_length_ = set_reference_lengths(problem);
  factor_.grow();
  problem.fit_pools();
  place_nodes(problem);
  weigh(problem);
  const auto has_moved = [&](std::uint32_t node) { return pattern_.has_moved(node_unknown_[node]); };
  place_items(problem, graph, [&](const auto& nodes, std::size_t count, std::uint32_t unknown) {
    return std::any_of(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(count), has_moved) ||
           (unknown != CouplingGraph::no_unknown && pattern_.has_moved(unknown));
  });
  pattern_.forget_moves();
  problem.note_compiled();
}

bool Assembly::place_forces(Problem& problem) const {
  bool are_coupled = true;
  problem.for_each_force_pool([&](auto& pool) {
    const std::size_t placed = pool.slots.size();
    resize_with_slack(pool.slots, pool.items.size());
    for (std::size_t i = placed; i < pool.items.size(); ++i) {
      const ForceArm& arm = pool.items[i].arm;
      for (std::uint32_t a = 0; a < arm.count; ++a)
        for (std::uint32_t b = a + 1; b < arm.count; ++b)
          are_coupled = are_coupled && pattern_.are_coupled(arm.nodes[a], arm.nodes[b]);
      if (are_coupled) set_slots(pool, i);
    }
  });
  return are_coupled;
}

// Gives slots to the items of which `is_due` says so: (nodes, how many, unknown of a constraint).
template <class IsDue>
void Assembly::place_items(Problem& problem, const CouplingGraph& graph, IsDue is_due) {
  for (auto& c : problem.mass_couplings)
    if (is_due(std::array{c.a, c.b}, 2, CouplingGraph::no_unknown)) c.slot = pattern_.pair_slot(c.a, c.b);
  auto constraint = graph.constraints.begin();
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i, ++constraint) {
      const auto count = static_cast<std::size_t>(pool.items[i].node_count());
      if (is_due(pool.items[i].nodes, count, constraint->unknown)) set_slots(pool, i, constraint->unknown);
    }
  });
  problem.for_each_force_pool([&](auto& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (is_due(pool.items[i].arm.nodes, pool.items[i].arm.count, CouplingGraph::no_unknown)) set_slots(pool, i);
  });
}

void Assembly::place_nodes(const Problem& problem) {
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

}  // namespace iota::solver
