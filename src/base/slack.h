// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace iota {

/// Leaves room for a few more: what grows by one now and then is not copied each time. Room that is never used is never
/// touched, so it takes no memory.
template <class T>
void reserve_with_slack(std::vector<T>& list, std::size_t size) {
  if (size > list.capacity()) list.reserve(size + size / 32 + 16);
}
template <class T>
void resize_with_slack(std::vector<T>& list, std::size_t size) {
  reserve_with_slack(list, size);
  list.resize(size);
}

}  // namespace iota
