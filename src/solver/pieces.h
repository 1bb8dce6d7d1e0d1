// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

#include <cstdint>
#include <vector>

namespace iota::solver {

/// Of what a problem's pieces are: lengths and coupled masses, as of rigid bodies and what shares their points; all rows; or
/// forces between points as well.
enum class Connection : std::uint8_t { lengths, rows, rows_and_forces };

/// Numbers the pieces by their lowest nodes; `piece_of` has that of each node. Returns how many there are.
std::uint32_t find_pieces(const Problem&, Connection, std::vector<std::uint32_t>& piece_of);

}  // namespace iota::solver
