// SPDX-License-Identifier: Apache-2.0
// Slots in the matrix: set by an analysis, or updated to follow a change of the problem.
#include "solver/assembly.h"

#include "base/slack.h"
#include "solver/sparse/pattern_builder.h"
#include "solver/sparse/pattern_cache.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

namespace iota::solver {

template <class C>
void Assembly::set_slots(ConstraintPool<C>& pool, std::size_t item, std::uint32_t unknown) const {
  auto& slots = pool.slots[item];
  const C& c = pool.items[item];
  const auto where = pattern_->constraint_slot(pool.nodes_of(c), unknown, slots.gradients.data());
  slots.unknown = where.unknown, slots.diagonal = where.diagonal, slots.stride = where.stride;
  if constexpr (C::has_curvature)
    for (int a = 0, pair = 0; a < pool.items[item].node_count(); ++a)
      for (int b = a + 1; b < pool.items[item].node_count(); ++b, ++pair)
        slots.pairs[pair] = pattern_->pair_slot(pool.items[item].nodes[a], pool.items[item].nodes[b]);
}

template <class F>
void Assembly::set_slots(ForcePool<F>& pool, std::size_t item) const {
  const ForceArm& arm = pool.items[item].arm;
  for (std::uint32_t a = 0, pair = 0; a < arm.count; ++a)
    for (std::uint32_t b = a + 1; b < arm.count; ++b, ++pair)
      pool.slots[item].pairs[pair] = pattern_->pair_slot(arm.nodes[a], arm.nodes[b]);
}

namespace {

/// Adds the items of which takes(nodes) says so: constraints in the order of the pools and of their items, with the unknowns
/// that they have had.
template <class Takes>
void add_to(CouplingGraph& graph, const Problem& problem, Takes takes) {
  for (const auto& c : problem.mass_couplings)
    if (takes(std::array{c.a, c.b})) graph.couplings.push_back({c.a, c.b});
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      if (!takes(pool.nodes_of(f))) continue;
      for (std::uint32_t i = 0; i < f.arm.count; ++i)
        for (std::uint32_t j = i + 1; j < f.arm.count; ++j) graph.couplings.push_back({f.arm.nodes[i], f.arm.nodes[j]});
    }
  });
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      if (!takes(pool.nodes_of(c))) continue;
      auto& added = graph.add(C::rows, pool.nodes_of(c));
      if (k < pool.slots.size()) added.unknown = pool.slots[k].unknown;
      if constexpr (GeneralConstraint<C>) {
        added.apart = true;
        added.first_side = static_cast<std::uint8_t>(c.first_side);
        added.always_behind_first_side = std::is_same_v<C, CouplingConstraint>;
        added.before_all = std::is_same_v<C, ContactConstraint>;
      }
    }
  });
}

/// An empty graph of this thread, which keeps the room of small ones: small problems are compiled often. A large one is
/// given up after its use: it takes 48 bytes a link.
class ThreadGraph {
 public:
  explicit ThreadGraph(const Problem& problem) {
    graph_.node_count = static_cast<std::uint32_t>(problem.size());
    graph_.couplings.clear(), graph_.constraints.clear(), graph_.nodes.clear(), graph_.places.clear();
    graph_.order.clear();
  }
  ~ThreadGraph() {
    if (graph_.node_count > most_kept_nodes) graph_ = {};
  }
  ThreadGraph(const ThreadGraph&) = delete;
  ThreadGraph& operator=(const ThreadGraph&) = delete;

  CouplingGraph& get() { return graph_; }

 private:
  static thread_local CouplingGraph graph_;
};
thread_local CouplingGraph ThreadGraph::graph_;

void fill(CouplingGraph& graph, const Problem& problem) {
  graph.places.assign(problem.position.begin(), problem.position.end());
  std::size_t constraints = 0;
  problem.for_each_constraint_pool([&](const auto& pool) { constraints += pool.items.size(); });
  graph.couplings.reserve(problem.mass_couplings.size());
  graph.constraints.reserve(constraints);
  graph.nodes.reserve(2 * constraints);
  add_to(graph, problem, [](auto&&) { return true; });
}

/// The nodes that a change concerns: changed ones, and those of their constraints.
class Near {
 public:
  explicit Near(const Problem& problem) {
    mark_.assign(problem.size(), far);
    for (const std::uint32_t node : problem.changes().changed) mark_[node] = changed;
    problem.for_each_constraint_pool([&](const auto& pool) {
      for (const auto& item : pool.items) {
        const auto nodes = pool.nodes_of(item);
        if (std::none_of(nodes.begin(), nodes.end(), [&](std::uint32_t n) { return mark_[n] == changed; })) continue;
        for (const std::uint32_t node : nodes)
          if (mark_[node] == far) mark_[node] = near;
      }
    });
  }
  template <class Nodes>
  bool has_any(const Nodes& nodes) const {
    for (const std::uint32_t node : nodes)  // a call of an algorithm took longer than these few comparisons
      if (mark_[node] != far) return true;
    return false;
  }

 private:
  enum Mark : std::uint8_t { far, near, changed };
  static thread_local std::vector<Mark> mark_;
};
thread_local std::vector<Near::Mark> Near::mark_;

/// Largest distance between the points of an arm, m.
double calc_extent(const ForceArm& arm, const Vec3* x) {
  double extent = 0;
  for (std::uint32_t i = 0; i < arm.count; ++i)
    for (std::uint32_t j = 0; j < i; ++j) extent = std::max(extent, norm(x[arm.nodes[i]] - x[arm.nodes[j]]));
  return extent;
}

double mean_reference_length(const Problem& problem) {
  double sum = 0;
  std::size_t count = 0;
  const auto& lengths = problem.pool_of<DistanceConstraint>();
  const auto add_lengths = [&](bool may_be_slack) {
    for (std::size_t k = 0; k < lengths.items.size(); ++k)
      if ((lengths.has_laws() && lengths.law(k)->is_one_sided()) == may_be_slack)
        sum += lengths.items[k].reference_length(), ++count;
  };
  add_lengths(false);
  if (count == 0)
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& f : pool.items)
        if (f.arm.is_internal()) sum += calc_extent(f.arm, problem.position.data()), ++count;
    });
  if (count == 0) add_lengths(true);  // a slack rope changes nothing, and so no tolerance
  return sum > 0 ? sum / static_cast<double>(count) : 1;
}

}  // namespace

double set_reference_lengths(Problem& problem) {
  const double length = mean_reference_length(problem);
  for (auto& c : problem.items_of<AffineConstraint>()) c.reference = length;
  return length;
}

bool Assembly::compile(Problem& problem, const KnownOrder& order) {
  reference_length_ = set_reference_lengths(problem);
  if (const std::uint64_t before = std::exchange(structure_, problem.structure());
      before == structure_ && problem.has_slots() && node_unknown_.size() == problem.size() &&
      pattern_ != own_pattern_) {
    for (auto& c : problem.mass_couplings) c.slot = pattern_->pair_slot(c.a, c.b);
    forget_factors();
    problem.fit_pools();
    weigh(problem);
    problem.note_compiled();
    return true;
  }
  ThreadGraph room(problem);
  CouplingGraph& graph = room.get();
  fill(graph, problem);
  graph.order = order;
  pattern_ = order.is_empty() ? PatternCache::of_thread().find(graph) : nullptr;
  if (!pattern_) own_pattern().analyze(graph), pattern_ = own_pattern_;
  factor_.reset(*pattern_);
  forget_factors();
  problem.fit_pools();
  auto constraint = graph.constraints.begin();
  problem.for_each_constraint_pool([&](auto& pool) {
    for (auto& slots : pool.slots) slots.unknown = constraint++->unknown;
  });
  set_slots_of_items(problem, [](auto&&...) { return true; });
  set_slots_of_nodes(problem);
  weigh(problem);
  problem.note_compiled();
  return false;
}

// A row yields by its compliance times its force, and a light link may carry the weight of all others: above a ratio of
// 1e7 the gap would be visible. Then forces are scaled by the stiffness of the point's rows, not by its mass alone:
// between two heavy loads the residual of a light point is round-off of their tension.
void Assembly::weigh(const Problem& problem) {
  constexpr double usual = 1e7;
  double heaviest = 0, lightest = std::numeric_limits<double>::infinity();
  for (const double m : problem.mass) heaviest = std::max(heaviest, m), lightest = std::min(lightest, m);
  row_compliance_ = lightest > 0 ? std::clamp(usual * lightest / heaviest, 1e-8, 1.0) : 1;
}

void Assembly::follow(Problem& problem) {
  ThreadGraph room(problem);
  CouplingGraph& graph = room.get();
  const Near near(problem);
  const auto is_near = [&](const auto& nodes) { return near.has_any(nodes); };
  add_to(graph, problem, is_near);
  const auto complete = [&] { add_to(graph, problem, [&](const auto& nodes) { return !is_near(nodes); }); };
  if (pattern_ != own_pattern_) own_pattern() = *pattern_, pattern_ = own_pattern_;
  const bool order_suits = PatternBuilder::follow_part(*own_pattern_, graph, problem.changes(), complete);
  problem.fit_pools();
  auto constraint = graph.constraints.begin();
  problem.for_each_constraint_pool([&](auto& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (is_near(pool.nodes_of(pool.items[i]))) pool.slots[i].unknown = constraint++->unknown;
  });
  problem.remove_nodes(problem.changes().removed);
  if (!order_suits) {
    compile(problem);
    return;
  }
  reference_length_ = set_reference_lengths(problem);
  factor_.grow(*pattern_);
  forget_factors();
  set_slots_of_nodes(problem);
  weigh(problem);
  const auto has_moved = [&](std::uint32_t node) { return pattern_->has_moved(node_unknown_[node]); };
  set_slots_of_items(problem, [&](const auto& nodes, std::uint32_t unknown) {
    if (unknown != CouplingGraph::no_unknown && pattern_->has_moved(unknown)) return true;
    for (const std::uint32_t node : nodes)
      if (has_moved(node)) return true;
    return false;
  });
  own_pattern_->forget_moves();
  problem.note_compiled();
}

bool Assembly::set_slots_of_forces(Problem& problem) const {
  bool are_coupled = true;
  problem.forget_slots();
  problem.for_each_force_pool([&](auto& pool) {
    const std::size_t before = pool.slots.size();
    resize_with_slack(pool.slots, pool.items.size());
    for (std::size_t i = before; i < pool.items.size(); ++i) {
      const ForceArm& arm = pool.items[i].arm;
      for (std::uint32_t a = 0; a < arm.count; ++a)
        for (std::uint32_t b = a + 1; b < arm.count; ++b)
          are_coupled = are_coupled && pattern_->are_coupled(arm.nodes[a], arm.nodes[b]);
      if (are_coupled) set_slots(pool, i);
    }
  });
  return are_coupled;
}

void Assembly::set_slots_of_velocity_forces(Problem& problem) const {
  if (problem.items_of<VelocityForce>().empty()) return;
  auto& pool = problem.pool_of<VelocityForce>();
  resize_with_slack(pool.slots, pool.items.size());
  for (std::size_t i = 0; i < pool.items.size(); ++i) set_slots(pool, i);
}

// Gives slots to the items of which `is_due` says so: (nodes, unknown of a constraint).
template <class IsDue>
void Assembly::set_slots_of_items(Problem& problem, IsDue is_due) {
  for (auto& c : problem.mass_couplings)
    if (is_due(std::array{c.a, c.b}, CouplingGraph::no_unknown)) c.slot = pattern_->pair_slot(c.a, c.b);
  problem.for_each_constraint_pool([&](auto& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (is_due(pool.nodes_of(pool.items[i]), pool.slots[i].unknown)) set_slots(pool, i, pool.slots[i].unknown);
  });
  problem.for_each_force_pool([&](auto& pool) {
    for (std::size_t i = 0; i < pool.items.size(); ++i)
      if (is_due(pool.nodes_of(pool.items[i]), CouplingGraph::no_unknown)) set_slots(pool, i);
  });
}

void Assembly::set_slots_of_nodes(const Problem& problem) {
  const auto n = static_cast<std::uint32_t>(problem.size());
  const auto make_room = [](std::size_t size, auto&... lists) { (resize_with_slack(lists, size), ...); };
  make_room(n, node_unknown_, node_diagonal_, node_stride_);
  for (std::uint32_t i = 0; i < n; ++i) {
    node_unknown_[i] = pattern_->node_unknown(i);
    node_diagonal_[i] = pattern_->node_diagonal(i);
    node_stride_[i] = pattern_->node_stride(i);
  }
  make_room(pattern_->unknown_count(), unknowns_);
}

}  // namespace iota::solver
