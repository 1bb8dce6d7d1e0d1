// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/block_pattern.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace iota::solver {

/// Makes the pattern of a graph, or makes a pattern follow a change of its graph. Both go through the same stages:
///   1. the order of the nodes
///   2. homes: the node with which, or behind which, each constraint's rows are eliminated
///   3. vertices: nodes with the rows at home in them, and rows that stand by themselves, in order of elimination
///   4. fronts: for each vertex the later ones that its elimination couples, and storage for their blocks
///   5. targets: where the elimination of each vertex subtracts its products
/// An analysis goes through them with all nodes, following a change with those it touches. One use each.
class PatternBuilder {
 public:
  PatternBuilder(BlockPattern& pattern, CouplingGraph& graph) : pattern_(pattern), graph_(graph) {}
  void analyze();
  void follow(const GraphChange&);

 private:
  using Vertex = BlockPattern::Vertex;
  using Entry = BlockPattern::Entry;
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr int max_rows_a_node = BlockPattern::max_pivot - 3;

  /// A constraint with the node behind which its rows have a vertex of their own.
  struct OwnRows {
    std::uint32_t node, constraint;
  };

  void order_all_nodes();
  void insert_nodes(const GraphChange&);

  void take_rows_off_touched_nodes(const GraphChange&);
  void find_homes();
  std::uint32_t find_node_for_rows_apart(const CouplingGraph::Constraint&) const;

  void make_vertices();
  void release_values(const Vertex&);
  void release(const Vertex&);
  void renumber_entries(const std::vector<Vertex>& old, const std::vector<std::uint32_t>& now_at);
  std::uint32_t home_of(const CouplingGraph::Constraint&) const;
  void list_rows_by_themselves();
  std::uint32_t rows_by_themselves_at(std::uint32_t unknown) const;

  void make_fronts();
  void list_couplings();
  void make_front(std::uint32_t vertex);
  void collect_front(std::uint32_t vertex);
  bool is_front_of(const Vertex&) const;
  void change_parent(std::uint32_t vertex, std::uint32_t before, std::uint32_t now);
  void store_front(Vertex&);

  void set_targets();
  void note_moves();
  void renumber_nodes(const GraphChange&);

  BlockPattern& pattern_;
  CouplingGraph& graph_;

  // By node.
  std::vector<std::uint32_t> node_order_, rank_;
  std::vector<std::uint8_t> is_touched_;  // may take rows
  std::vector<std::uint8_t> rows_at_;     // at home in it
  std::vector<std::uint8_t> is_listed_;   // `couplings_` has all of its couplings

  // By constraint.
  std::vector<std::uint32_t> homeless_;                        // in want of a home
  std::vector<std::pair<std::uint32_t, std::uint8_t>> homes_;  // of the homeless: node and first row; none: own rows
  std::vector<OwnRows> own_rows_;                              // new ones, in the order of their nodes

  // By vertex.
  std::vector<std::uint8_t> is_gone_;   // by old number
  std::vector<std::uint32_t> node_of_;  // none: rows by themselves
  std::vector<std::uint8_t> is_due_;    // its front may have changed
  std::vector<std::uint8_t> is_known_;  // `couplings_` has all that begin at it
  std::vector<std::uint8_t> is_moved_;  // its blocks lie elsewhere
  std::vector<std::uint32_t> first_child_, next_child_;
  std::vector<std::uint8_t> width_;                              // scratch of collect_front, else 0
  std::vector<std::pair<std::uint32_t, std::uint32_t>> own_at_;  // unknown and vertex of rows by themselves, sorted

  // The couplings that single elements make, by the vertex that is eliminated first.
  struct Coupling {
    std::uint32_t later;
    std::uint8_t width;  // of the later one's unknowns, those that are coupled
  };
  std::vector<std::uint32_t> first_coupling_;
  std::vector<Coupling> couplings_;
  std::vector<std::uint32_t> front_;  // scratch: later vertices, in order
};

}  // namespace iota::solver
