// SPDX-License-Identifier: Apache-2.0
#include "solver/pieces.h"

#include <algorithm>
#include <type_traits>

namespace iota::solver {

std::uint32_t find_pieces(const Problem& problem, Connection connection, std::vector<std::uint32_t>& piece_of,
                          DisjointSets& connected) {
  connected.reset(problem.size());
  const auto join = [&](std::uint32_t a, std::uint32_t b) {  // of two roots; the lowest of a piece is its leader
    connected.set_parent(std::max(a, b), std::min(a, b));
    return std::min(a, b);
  };
  const auto join_nodes = [&](std::span<const std::uint32_t> nodes) {
    std::uint32_t leader = connected.root(nodes.front());
    for (const std::uint32_t node : nodes.subspan(1)) leader = join(leader, connected.root(node));
  };
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
    if (connection == Connection::lengths && !std::is_same_v<C, DistanceConstraint>) return;
    if (connection == Connection::joints && std::is_same_v<C, ContactConstraint>) return;
    join_nodes(pool.nodes_of(pool.items[i]));
  });
  if (connection == Connection::rows_and_forces)
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& force : pool.items) join_nodes(pool.nodes_of(force));
    });
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
