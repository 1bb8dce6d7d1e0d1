// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/disjoint_sets.h"
#include "solver/holds.h"
#include "solver/problem.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace iota::solver {

/// Connections join points to pieces: lengths and coupled masses, as in rigid bodies and what shares their points; all rows that
/// act but contacts; contacts, too; or forces between points as well.
enum class Connection : std::uint8_t { lengths, joints, rows, rows_and_forces };

/// Which points of a problem are connected. Nails join nothing, but for `lengths`: what hangs on one nail swings by itself. A nail
/// (or some that rows connect, as of a static body) belongs to what hangs on it, unless nails are to be apart; if that is several
/// pieces, it is one of its own.
struct Pieces {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> of;        ///< each node; numbered by their lowest nodes
  std::vector<std::uint8_t> are_nails;  ///< each piece: of nails alone, on which others hang; empty if none is
  std::vector<std::uint32_t> nail_of;   ///< each node: its nail of the affine constraints, or `none`; may be empty

  bool is_nail(std::uint32_t piece) const { return !are_nails.empty() && are_nails[piece] != 0; }
  /// The piece that all of the nodes belong to, or hang on by a nail; `none` if these are several, or nails alone.
  std::uint32_t of_all(std::span<const std::uint32_t> nodes) const {
    std::uint32_t found = none;
    for (const std::uint32_t node : nodes) {
      const std::uint32_t piece = of[node];
      if (piece == found || is_nail(piece)) continue;
      if (found != none) return none;
      found = piece;
    }
    return found;
  }
};

/// The caller keeps this room, as rows that act may change in each step.
struct RoomForPieces {
  DisjointSets connected;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> hung;  // a nail and another node, of each connection with both
  std::vector<std::uint32_t> hanging;                         // on the leader of nails that are connected
};

enum class Nails : std::uint8_t { with_what_hangs_on_them, apart };

/// Returns how many pieces there are.
std::uint32_t find_pieces(const Problem&, Connection, Pieces&, RoomForPieces&, Nails = Nails::with_what_hangs_on_them);
inline std::uint32_t find_pieces(const Problem& problem, Connection connection, Pieces& pieces) {
  RoomForPieces room;
  return find_pieces(problem, connection, pieces, room);
}

/// A nail at the place at which a row holds a point of its other nodes: of a ball joint with a static body that of its ball. Nothing
/// if it holds a direction of them. nail_at(node): null where there is none.
template <class NailAt>
std::optional<AffineConstraint> fixed_place(const AffineConstraint& row, NailAt nail_at) {
  constexpr double no_weight = 1e-9;
  AffineConstraint nail{.target_start = row.target_start, .target = row.target};
  double weight = 0;  // of the other nodes
  for (std::uint32_t i = 0; i < row.count; ++i)
    if (const AffineConstraint* const fixed = nail_at(row.nodes[i])) {
      nail.target_start -= row.weights[i] * fixed->target_start, nail.target -= row.weights[i] * fixed->target;
    } else {
      weight += row.weights[i];
    }
  if (!(std::abs(weight) > no_weight)) return {};
  nail.target_start *= 1 / weight, nail.target *= 1 / weight;
  return nail;
}

/// Adds to `holds_of(piece)` how each piece is held, by rows and by the nails that it hangs on; with `joints` contacts do not count.
template <class HoldsOf>
void add_holds(const Problem& problem, Connection connection, const Pieces& pieces, HoldsOf holds_of) {
  if (pieces.are_nails.empty()) {
    problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
      if (connection == Connection::joints && is_of_contact<C>) return;
      holds_of(pieces.of[pool.nodes_of(pool.items[i]).front()]).add(pool.items[i]);
    });
    return;
  }
  const auto nails = problem.items_of<AffineConstraint>();
  const auto nail_at = [&](std::uint32_t node) {
    return pieces.is_nail(pieces.of[node]) ? &nails[pieces.nail_of[node]] : nullptr;
  };
  const auto add_nails = [&](std::span<const std::uint32_t> nodes, std::uint32_t piece) {
    for (const std::uint32_t node : nodes)
      if (const AffineConstraint* const nail = nail_at(node)) holds_of(piece).add_nail(*nail);
  };
  problem.for_each_acting([&]<class C>(const ConstraintPool<C>& pool, std::size_t i) {
    if (connection == Connection::joints && is_of_contact<C>) return;
    const C& c = pool.items[i];
    const auto nodes = pool.nodes_of(c);
    const std::uint32_t piece = pieces.of_all(nodes);
    if (piece == Pieces::none) return;
    if constexpr (std::is_same_v<C, AffineConstraint>)
      if (std::any_of(nodes.begin(), nodes.end(), nail_at)) {
        if (const auto nail = fixed_place(c, nail_at)) return holds_of(piece).add_nail(*nail);
        holds_of(piece).are_directions = true;
        return;
      }
    holds_of(piece).add(c), add_nails(nodes, piece);
  });
  if (connection == Connection::rows_and_forces)
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& force : pool.items) {
        const auto nodes = pool.nodes_of(force);
        if (const std::uint32_t piece = pieces.of_all(nodes); piece != Pieces::none) add_nails(nodes, piece);
      }
    });
  for (std::uint32_t piece = 0; piece < pieces.are_nails.size(); ++piece)
    if (pieces.is_nail(piece)) holds_of(piece).are_directions = true;  // it stays where it is
}

}  // namespace iota::solver
