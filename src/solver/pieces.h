// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/disjoint_sets.h"
#include "solver/problem.h"

#include <cstdint>
#include <vector>

namespace iota::solver {

/// Connections join points to pieces: lengths and coupled masses, as in rigid bodies and what shares their points; all rows that
/// act but contacts; contacts, too; or forces between points as well.
enum class Connection : std::uint8_t { lengths, joints, rows, rows_and_forces };

/// Numbers the pieces by their lowest nodes; `piece_of` has that of each node. Returns how many there are. What acts may
/// change in each step, so the caller keeps the room.
std::uint32_t find_pieces(const Problem&, Connection, std::vector<std::uint32_t>& piece_of, DisjointSets& room);
inline std::uint32_t find_pieces(const Problem& problem, Connection connection, std::vector<std::uint32_t>& piece_of) {
  DisjointSets room;
  return find_pieces(problem, connection, piece_of, room);
}

}  // namespace iota::solver
