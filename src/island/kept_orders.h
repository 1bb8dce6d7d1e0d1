// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"
#include "solver/sparse/coupling_graph.h"

#include <cstdint>
#include <span>
#include <vector>

namespace iota::island {

/// Finds the order of elimination that an island had when a snapshot was taken (Structure::eliminations), so that islands
/// which are built from the snapshot, or after it, give the same bits as those from which it was taken.
class KeptOrders {
 public:
  /// Takes those of a model. Lists that do not fit together count as none: an island without an order gets a new one.
  void read(const model::Model&);
  void clear() { index_of_ring_.clear(), ends_.clear(), work_.clear(); }
  /// For the points of an island, given by their rings, the order that an island of exactly these rings had; none if there
  /// was none.
  void find(std::span<const std::uint32_t> rings, solver::KnownOrder& order) const;

 private:
  std::vector<std::uint32_t> index_of_ring_;  // by slot; empty: there are no orders
  std::vector<std::uint32_t> ends_;           // of the orders, one after the other
  std::vector<double> work_;                  // of each
};

}  // namespace iota::island
