// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"

#include <algorithm>
#include <cstddef>

namespace iota::held {

/// Calls work(first, last) for pieces of `count` rows, on as many threads as pay.
template <class Work>
void in_chunks(std::size_t count, const Parallel& parallel, Work work) {
  constexpr std::size_t chunk = 2048;  // rows that a thread takes in one go
  parallel.for_each((count + chunk - 1) / chunk, 1,
                    [&](std::size_t c) { work(c * chunk, std::min(count, (c + 1) * chunk)); });
}

}  // namespace iota::held
