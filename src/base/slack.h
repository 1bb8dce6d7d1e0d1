// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace iota {

/// Reserves room for a few more items, so that a list which grows one by one is not copied each time. The operating
/// system allocates no memory for room that is never touched. Short lists get little: with room for 16 more items the
/// lists of thousands of islands of two points would be apart, and outside of the caches.
template <class T>
void reserve_with_slack(std::vector<T>& list, std::size_t size) {
  if (size > list.capacity()) list.reserve(size + std::min(size / 4, size / 32 + 16));
}
/// Reserves room for a quarter more items if there is none for one more: less is empty than if it doubled.
template <class T>
void reserve_a_quarter(std::vector<T>& list) {
  constexpr std::size_t few = 64;
  if (list.size() == list.capacity() && list.size() >= few) list.reserve(list.size() + list.size() / 4);
}
/// Reserves lists that most steps do not need, so that the first step which needs one does not wait for the allocator.
/// Not for lists of megabytes, whose cost is dominated by the first touch.
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
