// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"

#include <algorithm>
#include <cstddef>

namespace iota::held {

/// Calls work(first, last) for pieces of `count` rows, on several threads if that is faster.
template <class Work>
void in_chunks(std::size_t count, const Parallel& parallel, Work work) {
  constexpr std::size_t chunk = 2048;  // rows of one task
  parallel.for_each((count + chunk - 1) / chunk, 1,
                    [&](std::size_t c) { work(c * chunk, std::min(count, (c + 1) * chunk)); });
}

}  // namespace iota::held
