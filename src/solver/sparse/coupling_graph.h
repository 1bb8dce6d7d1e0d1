// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// Up to so many nodes a thread keeps the scratch of what it does to a structure: problems of this size change often, and
/// the scratch of a larger one is a considerable part of its memory.
inline constexpr std::uint32_t most_kept_nodes = 4096;

/// An order in which nodes are eliminated, that an analysis need not find.
struct KnownOrder {
  std::vector<std::uint32_t> nodes;
  /// The multiplications of a factorization when it was found, as those of the present number of nodes: if it comes to
  /// take much more, another order is found. 0: those that it takes now.
  double work = 0;

  bool is_empty() const { return nodes.empty(); }
  void clear() { nodes.clear(), work = 0; }
};

/// Which nodes and rows are coupled, before any order is known. A node has three unknowns (its position); a
/// constraint has 1 to 3 rows and touches a few nodes; couplings are pairs of nodes with a 3 x 3 block between them.
struct CouplingGraph {
  static constexpr std::uint32_t no_unknown = 0xffffffff;
  struct Constraint {
    std::uint8_t rows = 1;
    std::uint8_t node_count = 0;
    /// The gradient of a single node may vanish, so the rows need a pivot of their own, behind the nodes [0, first_side)
    /// or behind the others, whichever are eliminated first (0: behind all).
    bool apart = false;
    std::uint8_t first_side = 0;
    bool before_all = false;                ///< they yield enough to be eliminated before their nodes
    bool always_behind_first_side = false;  ///< the gradient of the other side may vanish as a whole
    std::uint32_t first_node = 0;           ///< in `nodes`
    /// The index of its first multiplier among the unknowns, which the pattern chooses. `BlockPattern::follow` gets the
    /// latest index, and `no_unknown` for a constraint that is new or has other nodes.
    std::uint32_t unknown = no_unknown;
  };
  std::uint32_t node_count = 0;
  std::vector<std::array<std::uint32_t, 2>> couplings;
  std::vector<Constraint> constraints;
  std::vector<std::uint32_t> nodes;  ///< of the constraints, one after the other
  std::vector<Vec3> places;          ///< of the nodes, which a dissection cuts apart; or empty
  KnownOrder order;                  ///< empty: to be found

  std::span<const std::uint32_t> nodes_of(const Constraint& c) const {
    return {nodes.data() + c.first_node, c.node_count};
  }
  std::span<std::uint32_t> nodes_of(const Constraint& c) { return {nodes.data() + c.first_node, c.node_count}; }
  Constraint& add(std::uint8_t rows, std::span<const std::uint32_t> of_constraint) {
    Constraint& added = constraints.emplace_back();
    added.rows = rows;
    added.node_count = static_cast<std::uint8_t>(of_constraint.size());
    added.first_node = static_cast<std::uint32_t>(nodes.size());
    nodes.insert(nodes.end(), of_constraint.begin(), of_constraint.end());
    return added;
  }
};

/// How a coupling graph has changed since its pattern was made.
struct GraphChange {
  /// Instead of a node to be beside: before all old ones, after those that were added to the front earlier.
  static constexpr std::uint32_t front = 0xffffffff;
  struct NewNode {
    std::uint32_t node;  ///< new nodes are numbered on from the old ones
    std::uint32_t
        beside;  ///< the node right after which it is eliminated: an old one, or one added earlier; or `front`
  };
  std::vector<NewNode> added;
  std::vector<std::uint32_t> removed;       ///< nodes that nothing refers to any more
  std::vector<std::uint32_t> changed;       ///< nodes that gained or lost a coupling or constraint, new ones included
  std::vector<std::uint32_t> removed_rows;  ///< first unknowns of constraints that are gone or have other nodes

  bool is_empty() const { return added.empty() && removed.empty() && changed.empty(); }
  void clear() { added.clear(), removed.clear(), changed.clear(), removed_rows.clear(); }
};

}  // namespace iota::solver
