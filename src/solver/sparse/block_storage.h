// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace iota::solver {

/// Allocates blocks of an array. A freed block is reused for the next one of the same size, so that an array with
/// changing blocks does not grow.
class BlockStorage {
 public:
  std::uint32_t take(std::uint32_t size) {
    used_ += size;
    if (const auto free = free_.find(size); free != free_.end() && !free->second.empty()) {
      const std::uint32_t offset = free->second.back();
      free->second.pop_back();
      return offset;
    }
    end_ += size;
    return end_ - size;
  }
  void give_back(std::uint32_t offset, std::uint32_t size) {
    if (size == 0) return;
    used_ -= size;
    free_[size].push_back(offset);
  }
  std::uint32_t size() const { return end_; }   ///< of the array
  std::uint32_t used() const { return used_; }  ///< of that in blocks at present
  void clear() { free_.clear(), end_ = used_ = 0; }

 private:
  std::uint32_t end_ = 0, used_ = 0;
  std::map<std::uint32_t, std::vector<std::uint32_t>> free_;  // offsets by size
};

}  // namespace iota::solver
