// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace iota::solver {

/// Allocates blocks of an array. A freed block is reused for the next one of the same size, so that an array with
/// changing blocks does not grow. Its own lists do not grow either: there are few sizes, and freed blocks share one list.
class BlockStorage {
 public:
  std::uint32_t take(std::uint32_t size) {
    used_ += size;
    const auto free = find(size);
    if (free == free_.end() || free->size != size || free->first == none) {
      end_ += size;
      return end_ - size;
    }
    const std::uint32_t freed = free->first;
    free->first = freed_[freed].next;
    freed_[freed].next = unused_, unused_ = freed;
    return freed_[freed].offset;
  }
  void give_back(std::uint32_t offset, std::uint32_t size) {
    if (size == 0) return;
    used_ -= size;
    auto free = find(size);
    if (free == free_.end() || free->size != size) {
      free_.reserve(8);
      free = free_.insert(find(size), {size, none});
    }
    free->first = note({offset, free->first});
  }
  std::uint32_t size() const { return end_; }   ///< of the array
  std::uint32_t used() const { return used_; }  ///< of that in blocks at present
  void clear() { free_.clear(), freed_.clear(), unused_ = none, end_ = used_ = 0; }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  /// The freed blocks of a size, the latest first.
  struct Free {
    std::uint32_t size, first;
  };
  struct Freed {
    std::uint32_t offset, next;
  };
  std::uint32_t note(Freed block) {
    const std::uint32_t at = unused_ != none ? unused_ : static_cast<std::uint32_t>(freed_.size());
    if (unused_ != none) {
      unused_ = freed_[at].next, freed_[at] = block;
    } else {
      freed_.reserve(32);
      freed_.push_back(block);
    }
    return at;
  }
  std::vector<Free>::iterator find(std::uint32_t size) {
    return std::lower_bound(free_.begin(), free_.end(), size,
                            [](const Free& free, std::uint32_t s) { return free.size < s; });
  }

  std::uint32_t end_ = 0, used_ = 0;
  std::vector<Free> free_;       // in order of size
  std::vector<Freed> freed_;     // blocks of all sizes
  std::uint32_t unused_ = none;  // the first one of these that is in use again, linked with the others
};

}  // namespace iota::solver
