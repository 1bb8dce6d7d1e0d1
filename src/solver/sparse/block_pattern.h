// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/block_storage.h"
#include "solver/sparse/coupling_graph.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// Elimination order and storage of a block-sparse matrix with the structure of
///   [ A  G' ]   A: node blocks, G: constraint rows, C: small compliance.
///   [ G -C  ]
/// The rows of a constraint are eliminated together with the first-eliminated of its nodes that has room (at most three
/// rows a node), so a node's pivot block is [A G'; G -C] of size 3 + rows and no pivot is structurally zero. Rows
/// without room, or that must be separate, become a vertex right after the last of their nodes (of one side). Minimum
/// degree on the node graph: no fill on trees, so everything is O(n) there.
class BlockPattern {
 public:
  static constexpr int max_pivot = 6;

  struct Vertex {
    std::uint8_t pivot = 3;      ///< unknowns eliminated here
    std::uint8_t positives = 3;  ///< number of first ones that should have positive pivots, the others negative
    /// Number of vertices from this one on that are alike, couple with one node each and not with each other: 2, or 1;
    /// 0: it couples with more than one node, or is in a panel.
    std::uint8_t leaves = 0;
    std::uint32_t first_entry = 0, entry_count = 0;
    std::uint32_t diagonal = 0;    ///< offset of the pivot x pivot block, among the diagonal ones
    std::uint32_t unknown = 0;     ///< offset in right-hand side and solution
    std::uint32_t first_pair = 0;  ///< see pair_targets

    bool is_node() const { return positives > 0; }
    bool holds(std::uint32_t u) const { return u >= unknown && u < unknown + pivot; }
    /// Whether it is eliminated in a panel, without a list of pairs, which would take more memory than the matrix.
    bool is_wide() const { return entry_count >= 8; }
    std::uint32_t pair_count() const { return is_wide() ? 0 : entry_count * (entry_count + 1) / 2; }
  };
  /// An off-diagonal block: the first `width` unknowns of a later vertex by the pivot columns of this one, row-major.
  /// Offsets of diagonal and off-diagonal blocks count separately: both triangles have the former in common.
  struct Entry {
    std::uint32_t vertex = 0;
    std::uint32_t offset = 0;
    std::uint32_t unknown = 0;
    std::uint8_t width = 3;
  };
  /// Vertices that are eliminated together as one dense block of columns: each is coupled first with the next one, and
  /// has few couplings that the last one does not have. They are eliminated when the last one is due.
  struct Panel {
    static constexpr int most_columns = 96;  ///< of a few strips of rows two such panels fit into the first cache
    std::uint32_t first = 0, count = 0;      ///< of `panel_vertices`
    std::uint32_t columns = 0;               ///< unknowns of its vertices
    std::uint32_t rows = 0;                  ///< columns, and unknowns of the last vertex's entries
  };
  /// The place of the 3 x 3 block of two nodes: in the block of the first-eliminated one.
  struct PairSlot {
    std::uint32_t offset = 0;
    std::uint8_t stride = 3;
    bool a_first = true;  ///< rows belong to the later node
  };
  /// The place of the gradient block (rows x 3) of a constraint and one of its nodes: element (row, column) at
  /// offset + row*row_stride + column*column_stride.
  struct GradientSlot {
    std::uint32_t offset = 0;
    std::uint8_t row_stride = 1, column_stride = 1;
    std::int8_t mirror = 0;        ///< in_diagonal: offset of the upper-triangle twin, with exchanged strides
    bool in_diagonal : 1 = false;  ///< in a diagonal block, else in an off-diagonal one
    bool lower_is_row : 1 = true;  ///< the lower triangle holds (row, node); otherwise (node, row)
  };
  static_assert(sizeof(GradientSlot) == 8, "there are two for each link");
  struct ConstraintSlot {
    std::uint32_t unknown = 0;   ///< of its first multiplier
    std::uint32_t diagonal = 0;  ///< of its first multiplier's diagonal entry
    std::uint8_t stride = 1;     ///< pivot size of its vertex: the next row's diagonal entry is stride + 1 further
  };

  /// Orders the nodes, unless the graph has their order, and lays out the storage; gives each constraint its unknown.
  void analyze(CouplingGraph&);

  /// Updates the pattern for a graph that has changed in a few places: the order stays, new nodes are placed beside
  /// others, and only fronts with changed couplings are rebuilt. The rows of changed nodes may get other unknowns. The
  /// last nodes then take the numbers of removed ones, the highest first. A cut in a chain of 10 000 links takes a
  /// tenth of what an analysis takes. Returns false if the order no longer suits the graph: analyze it.
  [[nodiscard]] bool follow(CouplingGraph&, const GraphChange&);
  /// Whether `follow` has moved the vertex of an unknown, or changed its node: then references to it have new slots.
  bool has_moved(std::uint32_t unknown) const { return moved_[unknown]; }
  /// Frees the memory behind `has_moved`, if it is much.
  void forget_moves() {
    if (moved_.size() > BlockPattern::max_pivot * most_kept_nodes) std::vector<std::uint8_t>().swap(moved_);
  }

  std::span<const Vertex> vertices() const { return vertices_; }
  std::span<const Entry> entries() const { return entries_; }
  std::span<const Panel> panels() const { return panels_; }
  std::span<const std::uint32_t> panel_vertices() const { return panel_vertices_; }
  /// The panel of each vertex, or `no_panel`; empty: there are none.
  std::span<const std::uint32_t> panel_of() const { return panel_of_; }
  static constexpr std::uint32_t no_panel = 0xffffffff;
  std::span<const std::uint32_t> pair_targets() const { return pair_targets_; }
  std::uint32_t diagonal_count() const { return diagonal_storage_.size(); }  ///< values in diagonal blocks
  std::uint32_t lower_count() const { return lower_storage_.size(); }  ///< values in off-diagonal blocks, one triangle
  std::uint32_t unknown_count() const { return unknown_storage_.size(); }  ///< some of them unused after `follow`
  std::uint32_t node_count() const { return static_cast<std::uint32_t>(node_vertex_.size()); }
  std::uint32_t widest_front() const { return widest_front_; }
  /// Number of used values in off-diagonal blocks: a measure of fill.
  std::uint32_t fill() const { return lower_storage_.used(); }

  /// The place of a node in the order of elimination, among those of nodes and of rows by themselves.
  std::uint32_t node_rank(std::uint32_t node) const { return node_vertex_[node]; }
  /// The work of a factorization, in multiplications, when the order was found, as that of the present number of nodes.
  double usual_work() const;
  double calc_work() const;  ///< of one now
  std::uint32_t node_unknown(std::uint32_t node) const { return vertices_[node_vertex_[node]].unknown; }
  std::uint32_t node_diagonal(std::uint32_t node) const { return vertices_[node_vertex_[node]].diagonal; }
  std::uint8_t node_stride(std::uint32_t node) const { return vertices_[node_vertex_[node]].pivot; }
  PairSlot pair_slot(std::uint32_t a, std::uint32_t b) const;
  /// Whether two nodes have a block, and so a slot.
  bool are_coupled(std::uint32_t a, std::uint32_t b) const;
  /// Slots of a constraint, from its nodes and its unknown in the graph; `gradients` has room for one per node.
  ConstraintSlot constraint_slot(std::span<const std::uint32_t> nodes, std::uint32_t unknown,
                                 GradientSlot* gradients) const;

 private:
  friend class PatternBuilder;
  void find_panels();
  void find_leaves();
  std::uint32_t find_entry(std::uint32_t vertex, std::uint32_t later_vertex) const;
  std::uint32_t find_home(std::span<const std::uint32_t> nodes, std::uint32_t unknown) const;

  std::vector<Vertex> vertices_;  // in order of elimination
  std::vector<Entry> entries_;    // of each vertex, in order of elimination
  std::vector<std::uint32_t> pair_targets_;
  std::vector<std::uint32_t> node_vertex_;
  std::vector<Panel> panels_;  // in order of elimination
  std::vector<std::uint32_t> panel_vertices_, panel_of_;
  BlockStorage diagonal_storage_, lower_storage_, unknown_storage_, entry_storage_, pair_storage_;
  std::uint32_t widest_front_ = 0;
  double analyzed_work_ = 0;          // of the latest analysis
  std::uint32_t analyzed_nodes_ = 0;  // its nodes
  double wasted_work_ = 0;            // since then, see `follow_part`
  std::vector<std::uint8_t> moved_;   // of each unknown
};

/// Nodes in order of elimination. Minimum degree, O(n) on trees; with much fill, nested dissection by places, O(n log^2
/// n).
void find_elimination_order(std::uint32_t node_count, std::span<const std::array<std::uint32_t, 2>> edges,
                            std::span<const Vec3> places, std::vector<std::uint32_t>& order);

}  // namespace iota::solver
