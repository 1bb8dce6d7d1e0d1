// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"

namespace iota::solver {

/// Whether joints connect bodies, or bodies and the world, in loops, or lengths connect points by others than those of a chain or of a
/// body of up to four points. Otherwise no two rows hold the same. By the structure alone, whether rows act or not; contacts do not
/// count. O(n log n).
bool has_loops(const Problem&);

}  // namespace iota::solver
