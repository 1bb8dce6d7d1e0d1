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
/// For what most steps do not need: the first that does should not wait for memory, unless it is megabytes, which it waits
/// for anyway when it touches them.
template <class T>
void reserve_for_rare_use(std::vector<T>& list, std::size_t size) {
  if (size <= 4096) reserve_with_slack(list, size);
}
template <class T>
void resize_with_slack(std::vector<T>& list, std::size_t size) {
  reserve_with_slack(list, size);
  list.resize(size);
}

}  // namespace iota
