// SPDX-License-Identifier: Apache-2.0
#include "solver/pieces.h"

#include <algorithm>
#include <array>

namespace iota::solver {

namespace {

/// visit(nodes): what a connection joins.
template <class Visit>
void for_each_connected(const Problem& problem, Connection connection, Visit visit) {
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
    if (connection == Connection::lengths && !std::is_same_v<C, DistanceConstraint>) return;
    if (connection == Connection::joints && is_of_contact<C>) return;
    visit(pool.nodes_of(pool.items[i]));
  });
  if (connection == Connection::rows_and_forces)
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& force : pool.items) visit(pool.nodes_of(force));
    });
  for (const auto& c : problem.mass_couplings) visit(std::array{c.a, c.b});
}

/// Returns whether there is a nail.
bool find_nails(const Problem& problem, std::vector<std::uint32_t>& nail_of) {
  const auto affines = problem.items_of<AffineConstraint>();
  nail_of.clear();
  for (std::uint32_t i = 0; i < affines.size(); ++i) {
    if (!affines[i].is_nail()) continue;
    if (nail_of.empty()) nail_of.assign(problem.size(), Pieces::none);
    nail_of[affines[i].nodes[0]] = i;
  }
  return !nail_of.empty();
}

}  // namespace

std::uint32_t find_pieces(const Problem& problem, Connection connection, Pieces& pieces, RoomForPieces& room,
                          Nails nails) {
  constexpr std::uint32_t none = Pieces::none, several = none - 1;
  auto& [connected, hung, hanging] = room;
  connected.reset(problem.size());
  const auto join = [&](std::uint32_t a, std::uint32_t b) {  // the lowest of a piece is its leader
    const std::uint32_t p = connected.root(a), q = connected.root(b);
    connected.set_parent(std::max(p, q), std::min(p, q));
  };
  const bool end_at_nails = connection != Connection::lengths && find_nails(problem, pieces.nail_of);
  hung.clear();
  for_each_connected(problem, connection, [&](std::span<const std::uint32_t> nodes) {
    if (!end_at_nails) {
      for (std::size_t k = 1; k < nodes.size(); ++k) join(nodes[k - 1], nodes[k]);
      return;
    }
    std::uint32_t nail = none, other = none;  // the last ones
    for (const std::uint32_t node : nodes) {
      std::uint32_t& last = pieces.nail_of[node] != none ? nail : other;
      if (last != none) join(last, node);
      last = node;
    }
    if (nail != none && other != none) hung.emplace_back(nail, other);
  });
  hanging.assign(end_at_nails ? problem.size() : 0, none);
  for (const auto& [nail, node] : hung) {
    const std::uint32_t leader = connected.root(node);
    std::uint32_t& found = hanging[connected.root(nail)];
    found = found == none || found == leader ? leader : several;
  }
  if (nails == Nails::with_what_hangs_on_them)
    for (std::uint32_t node = 0; node < hanging.size(); ++node)
      if (hanging[node] < several) join(node, hanging[node]);
  std::uint32_t count = 0;
  pieces.of.resize(problem.size()), pieces.are_nails.clear();
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    const std::uint32_t before = connected.parent(node);  // a lower one of the same piece, but for its leader
    pieces.of[node] = before == node ? count++ : pieces.of[before];
  }
  for (std::uint32_t node = 0; node < hanging.size(); ++node)
    if (hanging[node] == several || (hanging[node] != none && nails == Nails::apart))
      pieces.are_nails.resize(count), pieces.are_nails[pieces.of[node]] = 1;
  return count;
}

}  // namespace iota::solver
