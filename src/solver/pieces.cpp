// SPDX-License-Identifier: Apache-2.0
#include "solver/pieces.h"

#include "base/disjoint_sets.h"

#include <algorithm>

namespace iota::solver {

std::uint32_t find_pieces(const Problem& problem, Connection connection, std::vector<std::uint32_t>& piece_of) {
  DisjointSets connected(problem.size());
  const auto join = [&](std::uint32_t a, std::uint32_t b) {  // of two roots; the lowest of a piece is its leader
    connected.set_parent(std::max(a, b), std::min(a, b));
    return std::min(a, b);
  };
  const auto join_all = [&](const auto& pool) {
    for (const auto& item : pool.items) {
      const auto nodes = pool.nodes_of(item);
      std::uint32_t leader = connected.root(nodes.front());
      for (const std::uint32_t node : nodes.subspan(1)) leader = join(leader, connected.root(node));
    }
  };
  if (connection == Connection::lengths)
    join_all(problem.pool_of<DistanceConstraint>());
  else
    problem.for_each_constraint_pool(join_all);
  if (connection == Connection::rows_and_forces) problem.for_each_force_pool(join_all);
  for (const auto& c : problem.mass_couplings) join(connected.root(c.a), connected.root(c.b));
  std::uint32_t count = 0;
  piece_of.resize(problem.size());
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    const std::uint32_t leader = connected.root(node);
    piece_of[node] = leader == node ? count++ : piece_of[leader];
  }
  return count;
}

}  // namespace iota::solver
