// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace iota {

namespace detail {

constexpr std::size_t few_to_sort = 64;       ///< are sorted by comparing them
constexpr std::uint32_t sparse_to_sort = 16;  ///< so many numbers of the range for each one of a list, too

/// Marks numbers that lie close to each other in a row of bits, and reads them in order. False, without a change: they are few, or far
/// from each other.
inline bool sort_unique_dense(std::vector<std::uint32_t>& list) {
  if (list.size() < few_to_sort) return false;
  const auto [least, most] = std::minmax_element(list.begin(), list.end());
  const std::uint32_t first = *least, range = *most - first;
  if (range / sparse_to_sort >= list.size()) return false;
  thread_local std::vector<std::uint64_t> marks;
  marks.assign(range / 64 + 1, 0);
  for (const std::uint32_t number : list) marks[(number - first) / 64] |= std::uint64_t{1} << ((number - first) % 64);
  list.clear();
  for (std::uint32_t word = 0; word < marks.size(); ++word)
    for (std::uint64_t left = marks[word]; left != 0; left &= left - 1)
      list.push_back(first + 64 * word + static_cast<std::uint32_t>(std::countr_zero(left)));
  return true;
}

/// Pairs go to a bucket of their first number each, where few are to be compared. False, without a change, as above.
inline bool sort_unique_dense(std::vector<std::pair<std::uint32_t, std::uint32_t>>& list) {
  if (list.size() < few_to_sort) return false;
  std::uint32_t least = list.front().first, most = least;
  for (const auto& pair : list) least = std::min(least, pair.first), most = std::max(most, pair.first);
  if ((most - least) / sparse_to_sort >= list.size()) return false;
  thread_local std::vector<std::uint32_t> ends, seconds;
  ends.assign(most - least + 1, 0), seconds.resize(list.size());
  for (const auto& pair : list) ++ends[pair.first - least];
  std::uint32_t begin = 0;
  for (std::uint32_t& end : ends) begin += std::exchange(end, begin);
  for (const auto& pair : list) seconds[ends[pair.first - least]++] = pair.second;
  list.clear();
  begin = 0;
  for (std::uint32_t bucket = 0; bucket < ends.size(); ++bucket) {
    const auto at = seconds.begin() + begin, end = seconds.begin() + ends[bucket];
    std::sort(at, end);
    std::for_each(at, std::unique(at, end), [&](std::uint32_t second) { list.push_back({least + bucket, second}); });
    begin = ends[bucket];
  }
  return true;
}

}  // namespace detail

/// Each value once, in order.
template <class T>
void sort_unique(std::vector<T>& list) {
  if constexpr (requires { detail::sort_unique_dense(list); })
    if (detail::sort_unique_dense(list)) return;
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace iota
