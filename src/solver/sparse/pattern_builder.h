// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/function_ref.h"
#include "base/renumbering.h"
#include "solver/sparse/block_pattern.h"

#include <compare>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace iota::solver {

/// Makes the pattern of a graph, or makes a pattern follow a change of its graph. Both go through the same stages:
///   1. the order of the nodes
///   2. homes: the node with which, or after which, each constraint's rows are eliminated
///   3. vertices: nodes with their rows, and separate rows, in order of elimination
///   4. fronts: for each vertex the later ones that its elimination couples, and storage for their blocks
///   5. targets: where the elimination of each vertex subtracts its products
/// An analysis uses all nodes, following a change only the changed ones.
class PatternBuilder {
 public:
  /// The builder of this thread, which keeps the room of small patterns: these are made too often to allocate it each time.
  static PatternBuilder& of_thread(BlockPattern&, CouplingGraph&);
  void analyze();
  /// BlockPattern::follow of a graph that has no more than what couples with the changed nodes and with the nodes of their
  /// constraints; `complete` adds the rest behind it, and few changes spread so far that it is called.
  [[nodiscard]] static bool follow_part(BlockPattern&, CouplingGraph&, const GraphChange&,
                                        FunctionRef<void()> complete);

 private:
  PatternBuilder() = default;
  void begin(BlockPattern&, CouplingGraph&);
  void end();
  void follow(const GraphChange&, FunctionRef<void()> complete);

  using Vertex = BlockPattern::Vertex;
  using Entry = BlockPattern::Entry;
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr int max_rows_a_node = BlockPattern::max_pivot - 3;

  /// A constraint with separate rows, the node before them, and their number among all.
  struct OwnRows {
    std::uint32_t node, constraint, number;
    bool is_behind;  ///< the node, or before it
  };
  void give_own_rows(std::uint32_t constraint, std::uint32_t node, bool is_behind = true) {
    own_rows_.push_back({node, constraint, static_cast<std::uint32_t>(own_rows_.size()), is_behind});
  }

  void order_all_nodes();
  void find_insertions(const GraphChange&);
  std::uint64_t rank_of(std::uint32_t node) const;

  void take_rows_off_changed_nodes(const GraphChange&);
  void list(std::uint32_t node);
  void find_homes();
  std::uint32_t find_node_for_rows_apart(const CouplingGraph::Constraint&) const;

  void make_all_vertices();
  void renew_vertices(const GraphChange&);
  void list_changing_vertices(const GraphChange&);
  std::uint32_t add_vertex(Vertex, bool is_resized);
  void add_own_rows_of(std::uint32_t node, bool is_behind);
  void note_homes(std::size_t nodes);
  void release_values(const Vertex&);
  void release(const Vertex&);
  void renumber_entries(const std::vector<Vertex>& old, std::span<const std::uint32_t> changing);
  std::uint32_t home_of(const CouplingGraph::Constraint&) const;
  void list_rows_by_themselves(std::size_t nodes);
  std::uint32_t rows_by_themselves_at(std::uint32_t unknown) const;

  void make_fronts(FunctionRef<void()> complete);
  void list_couplings();
  void make_front(std::uint32_t vertex, FunctionRef<void()> complete);
  void collect_front(std::uint32_t vertex);
  bool is_front_of(const Vertex&) const;
  void change_parent(std::uint32_t vertex, std::uint32_t before, std::uint32_t now);
  void store_front(Vertex&);

  void set_targets();
  void note_moves(const GraphChange&);
  void renumber_nodes(const GraphChange&);

  BlockPattern* pattern_ = nullptr;
  CouplingGraph* graph_ = nullptr;

  // By node.
  std::uint32_t old_nodes_ = 0;               // how many are in the order that there is
  std::vector<std::uint32_t> node_order_;     // of an analysis
  std::vector<std::uint8_t> is_changed_;      // may get rows
  std::vector<std::uint8_t> rows_at_;         // at home in it; of those that are changed or listed
  std::vector<std::uint8_t> is_listed_;       // `couplings_` has all of its couplings
  std::vector<std::uint32_t> listed_;         // these
  bool all_are_listed_ = false;               // or all
  std::vector<std::uint64_t> rank_of_added_;  // of each new node: see rank_of

  /// New nodes in their order, each with the number of old vertices that it comes after.
  struct Insertion {
    std::uint32_t after, node;
    friend auto operator<=>(const Insertion&, const Insertion&) = default;
  };
  std::vector<Insertion> insertions_;

  // By constraint.
  std::vector<std::uint32_t> homeless_;                        // without a home
  std::vector<std::pair<std::uint32_t, std::uint8_t>> homes_;  // of the homeless: node and first row; none: own rows
  std::vector<OwnRows> own_rows_;                              // new ones, in the order of their nodes
  std::size_t next_own_rows_ = 0;                              // of these, to get a vertex next

  // By vertex.
  std::vector<std::uint8_t> is_gone_;   // by old number
  std::vector<std::uint32_t> now_at_;   // by old number
  std::vector<std::uint8_t> is_due_;    // its front may have changed
  std::vector<std::uint8_t> is_known_;  // `couplings_` has all that begin at it
  std::vector<std::uint8_t> is_moved_;  // its blocks have moved
  std::vector<std::uint32_t> first_child_, next_child_;
  std::vector<std::uint8_t> width_;                              // scratch of collect_front, else 0
  std::vector<std::pair<std::uint32_t, std::uint32_t>> own_at_;  // unknown and vertex of separate rows, sorted

  // The couplings by single elements, by the vertex that is eliminated first.
  struct Coupling {
    std::uint32_t later;
    std::uint8_t width;  // of the later one's unknowns, those that are coupled
  };
  std::vector<std::uint32_t> first_coupling_;
  std::vector<Coupling> couplings_;

  // Scratch.
  std::vector<std::uint32_t> front_;  // later vertices, in order
  std::vector<std::uint32_t> scratch_, changing_;
  Renumbering number_;
  std::vector<Vertex> old_vertices_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<std::pair<std::uint32_t, Coupling>> found_;
};

}  // namespace iota::solver
