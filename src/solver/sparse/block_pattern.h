// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace iota::solver {

/// What couples with what, before any order is known. A node has three unknowns (its position); a constraint has 1 to 3
/// rows and touches a few nodes; couplings are pairs of nodes with a 3 x 3 block between them.
struct CouplingGraph {
  static constexpr int max_constraint_nodes = 8;
  struct Constraint {
    std::uint8_t rows = 1;
    std::uint8_t node_count = 0;
    std::array<std::uint32_t, max_constraint_nodes> nodes{};
    /// The gradient of a single node may vanish, so the rows need a pivot of their own, behind the nodes [0, first_side)
    /// or behind the others, whichever are eliminated first (0: behind all).
    bool apart = false;
    std::uint8_t first_side = 0;
  };
  std::uint32_t node_count = 0;
  std::vector<std::array<std::uint32_t, 2>> couplings;
  std::vector<Constraint> constraints;
};

/// A local change of a coupling graph.
struct GraphChange {
  /// Constraints of one row that touch a node in `touched`, or a node of another such constraint, as they are now.
  struct Constraint {
    std::array<std::uint32_t, 2> nodes{};
    std::uint32_t unknown = 0;  ///< of its multiplier before the change
  };
  std::vector<std::array<std::uint32_t, 2>> added;  ///< new nodes, numbered on from the old ones, and an old one each
                                                    ///< whose neighbor in the order it becomes
  std::vector<std::uint32_t> removed;               ///< nodes that nothing refers to any more
  std::vector<std::uint32_t> touched;               ///< all whose couplings changed, those included
  std::vector<Constraint> constraints;
  /// Lists the nodes that a node is coupled with now, in any order, twins allowed.
  std::function<void(std::uint32_t node, std::vector<std::uint32_t>& with)> neighbors;
};

/// Elimination order and storage of a block-sparse matrix with the structure of
///   [ A  G' ]   A: node blocks, G: constraint rows, C: small compliance.
///   [ G -C  ]
/// The rows of a constraint are eliminated together with the first-eliminated of its nodes that has room (at most three
/// rows a node), so a node's pivot block is [A G'; G -C] of size 3 + rows and no pivot is ever structurally zero. Rows
/// that find no room, or must stand apart, become a vertex of their own right after the last of their nodes (of one
/// side's). Minimum degree on the node graph: no fill on trees, so everything is O(n) there.
class BlockPattern {
 public:
  static constexpr int max_pivot = 6;

  struct Vertex {
    std::uint8_t pivot = 3;      ///< unknowns eliminated here
    std::uint8_t positives = 3;  ///< of which the first so many should have positive pivots, the others negative
    std::uint32_t first_entry = 0, entry_count = 0;
    std::uint32_t diagonal = 0;    ///< offset of the pivot x pivot block, among the diagonal ones
    std::uint32_t unknown = 0;     ///< offset in right-hand side and solution
    std::uint32_t first_pair = 0;  ///< see pair_targets
  };
  /// An off-diagonal block: the first `width` unknowns of a later vertex by the pivot columns of this one, row-major.
  /// Offsets of diagonal and off-diagonal blocks count separately: both triangles have the former in common.
  struct Entry {
    std::uint32_t vertex = 0;
    std::uint32_t offset = 0;
    std::uint32_t unknown = 0;
    std::uint8_t width = 3;
  };
  /// Where the 3 x 3 block of two nodes lies: in the block of the first-eliminated one.
  struct PairSlot {
    std::uint32_t offset = 0;
    std::uint8_t stride = 3;
    bool a_first = true;  ///< rows belong to the later node
  };
  /// Where the gradient block (rows x 3) of a constraint and one of its nodes lies: element (row, column) at
  /// offset + row*row_stride + column*column_stride.
  struct GradientSlot {
    std::uint32_t offset = 0;
    std::uint8_t row_stride = 1, column_stride = 1;
    std::int8_t mirror = 0;        ///< in_diagonal: how much further the upper-triangle twin begins, strides exchanged
    bool in_diagonal : 1 = false;  ///< in a diagonal block, else in an off-diagonal one
    bool lower_is_row : 1 = true;  ///< the lower triangle holds (row, node); otherwise (node, row)
  };
  static_assert(sizeof(GradientSlot) == 8, "there are two for each link");
  struct ConstraintSlot {
    std::uint32_t unknown = 0;   ///< of its first multiplier
    std::uint32_t diagonal = 0;  ///< of its first multiplier's diagonal entry
    std::uint8_t stride = 1;     ///< pivot size of its vertex: the next row's diagonal entry is stride + 1 further
    std::array<GradientSlot, CouplingGraph::max_constraint_nodes> gradients{};
  };

  void analyze(const CouplingGraph&);

  /// Follows a small change of the graph without looking at the rest of it: the order stays, new nodes take their places
  /// beside others, and only fronts whose couplings changed are made anew. Costs a few nanoseconds a node. False where
  /// that would not do (too much changes, rows without room); the pattern is then unusable until the next `analyze`.
  bool adapt(const GraphChange&);
  /// The nodes in whose vertex something moved in the latest `adapt`, by their numbers in the change: what touches
  /// one of them has new slots.
  std::span<const std::uint8_t> moved() const { return moved_; }
  /// After `adapt`: the slot of constraint i of the change.
  const ConstraintSlot& adapted_slot(std::size_t i) const { return constraint_slots_[i]; }
  /// After `adapt`: the slot of a constraint that is not in the change, from the unknown it has had all the time.
  ConstraintSlot find_slot(std::span<const std::uint32_t> nodes, std::uint32_t unknown) const;
  /// After `adapt`: removed nodes leave their numbers to the last ones, the highest first.
  void renumber(std::span<const std::uint32_t> removed);

  std::span<const Vertex> vertices() const { return vertices_; }
  std::span<const Entry> entries() const { return entries_; }
  std::span<const std::uint32_t> pair_targets() const { return pair_targets_; }
  std::uint32_t diagonal_count() const { return diagonal_count_; }  ///< values in diagonal blocks
  std::uint32_t lower_count() const { return lower_count_; }        ///< values in off-diagonal blocks, of one triangle
  std::uint32_t unknown_count() const { return unknown_count_; }
  std::uint32_t node_count() const { return static_cast<std::uint32_t>(node_vertex_.size()); }
  std::uint32_t widest_front() const { return widest_front_; }

  std::uint32_t node_unknown(std::uint32_t node) const { return vertices_[node_vertex_[node]].unknown; }
  std::uint32_t node_diagonal(std::uint32_t node) const { return vertices_[node_vertex_[node]].diagonal; }
  std::uint8_t node_stride(std::uint32_t node) const { return vertices_[node_vertex_[node]].pivot; }
  PairSlot pair_slot(std::uint32_t a, std::uint32_t b) const;
  const ConstraintSlot& constraint_slot(std::size_t constraint) const { return constraint_slots_[constraint]; }
  /// The slots are needed once, and larger than all the rest.
  void forget_slots() { std::vector<ConstraintSlot>().swap(constraint_slots_); }

 private:
  ConstraintSlot calc_slot(std::span<const std::uint32_t> nodes, std::uint32_t home, std::uint8_t row) const;
  /// Fills the pair targets of a front, from its first_pair on.
  void set_targets(const Vertex&);
  std::uint32_t find_entry(std::uint32_t vertex, std::uint32_t later_vertex) const;

  std::vector<Vertex> vertices_;  // in order of elimination
  std::vector<Entry> entries_;    // of each vertex, in order of elimination
  std::vector<std::uint32_t> pair_targets_;
  std::vector<std::uint32_t> node_vertex_;
  std::vector<ConstraintSlot> constraint_slots_;
  std::uint32_t diagonal_count_ = 0, lower_count_ = 0, unknown_count_ = 0, widest_front_ = 0;
  std::uint32_t given_up_ = 0;  // values that `adapt` no longer uses
  std::vector<std::uint8_t> moved_;
};

/// Nodes in order of elimination: minimum degree, ties by number. O(n) on trees.
std::vector<std::uint32_t> minimum_degree_order(std::uint32_t node_count,
                                                std::span<const std::array<std::uint32_t, 2>> edges);

}  // namespace iota::solver
