// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace iota {

/// The numbers of some items after others were removed: the last items take the numbers of removed ones, the highest
/// first. Takes the time of what is removed.
class Renumbering {
 public:
  void set(std::size_t count, std::span<const std::uint32_t> removed) {
    highest_first_.assign(removed.begin(), removed.end());
    std::sort(highest_first_.begin(), highest_first_.end(), std::greater<>());
    count_ = static_cast<std::uint32_t>(count - removed.size());
    item_at_.resize(removed.size()), number_.resize(removed.size());
    for (std::uint32_t i = 0; i < removed.size(); ++i) item_at_[i] = number_[i] = count_ + i;
    auto last = static_cast<std::uint32_t>(count);
    for (const std::uint32_t at : highest_first_) {
      const std::uint32_t moved = item_at_[--last - count_];
      if (at >= count_)
        item_at_[at - count_] = moved;
      else
        number_[moved - count_] = at;
    }
  }
  /// The new number of an item that is still there.
  std::uint32_t operator()(std::uint32_t item) const { return item < count_ ? item : number_[item - count_]; }
  /// Moves the items of a list.
  template <class T>
  void apply(std::vector<T>& list) const {
    for (const std::uint32_t at : highest_first_) list[at] = list.back(), list.pop_back();
  }

 private:
  std::uint32_t count_ = 0;                   // of the remaining ones
  std::vector<std::uint32_t> highest_first_;  // the removed ones
  std::vector<std::uint32_t> item_at_;        // scratch: at the last places
  std::vector<std::uint32_t> number_;         // of the last items
};

}  // namespace iota
