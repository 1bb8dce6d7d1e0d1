// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/block_pattern.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace iota::solver {

/// Patterns of small graphs. Thousands of loose bodies have the same graph, and when they are tied and parted, the same
/// few graphs come and go: equal problems share a pattern. The result is that of BlockPattern::analyze. Most graphs of
/// several tied bodies come once, so a graph is kept from its second time on.
class PatternCache {
 public:
  /// The pattern of a graph, whose constraints get their unknowns; null: analyze it. It is not small, comes for the first
  /// time, or patterns that are in use have all places where it could be kept.
  std::shared_ptr<const BlockPattern> find(CouplingGraph&);
  /// The cache of this thread, since problems are compiled on several threads.
  static PatternCache& of_thread();

  /// With more nodes graphs are seldom equal. With more than 42 their order might depend on places: their elimination
  /// couples up to n (n^2 - 1) / 6 pairs, see `find_elimination_order`.
  static constexpr std::uint32_t most_nodes = 24;

 private:
  using Key = std::vector<std::uint32_t>;  // all numbers of a graph
  struct Known {
    std::uint64_t hash = 0;
    Key key;
    std::shared_ptr<BlockPattern> pattern;
    std::vector<std::uint32_t> unknowns;  ///< of the constraints
  };
  /// Graphs of which the hash has the same last bits. The oldest that no problem uses makes room for a new one.
  struct Set {
    std::array<Known, 8> known;
    std::uint32_t next = 0;
  };
  static constexpr std::size_t set_count = 512, seen_count = 8192;
  std::uint64_t note_key(const CouplingGraph&);
  Known* find_room(Set&);

  std::vector<std::unique_ptr<Set>> sets_;
  std::vector<std::uint32_t> seen_;  // other bits of hashes, of the latest graphs
  // Scratch. A kept pattern is a copy, which has no more room than it needs.
  Key key_;
  BlockPattern analyzed_;
};

}  // namespace iota::solver
