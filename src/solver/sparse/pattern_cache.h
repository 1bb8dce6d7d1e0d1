// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/block_pattern.h"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace iota::solver {

/// Patterns of small graphs. Thousands of loose bodies have the same graph, and when they are tied and parted, the same
/// few graphs come and go: each is analyzed once, and equal problems share its pattern. The result is that of
/// BlockPattern::analyze.
class PatternCache {
 public:
  /// The pattern of a graph, whose constraints get their unknowns; null: it is not small.
  std::shared_ptr<const BlockPattern> find(CouplingGraph&);
  /// That of this thread, since problems are compiled on several threads.
  static PatternCache& of_thread();

  /// With more nodes graphs are seldom equal. With more than 42 their order might depend on places: their elimination
  /// couples up to n (n^2 - 1) / 6 pairs, see `elimination_order`.
  static constexpr std::uint32_t most_nodes = 24;

 private:
  struct Known {
    std::shared_ptr<const BlockPattern> pattern;
    std::vector<std::uint32_t> unknowns;  ///< of the constraints
  };
  using Key = std::vector<std::uint32_t>;  // all numbers of a graph

  std::map<Key, Known> known_;
  Key key_;  // scratch
};

}  // namespace iota::solver
