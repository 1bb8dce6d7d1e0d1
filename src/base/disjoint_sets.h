// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace iota {

/// Sets of the numbers below some size that are joined in pairs; with path halving (Tarjan and van Leeuwen 1984).
class DisjointSets {
 public:
  DisjointSets() = default;
  explicit DisjointSets(std::size_t size) { reset(size); }

  /// Each number alone again; allocates only for more numbers than ever before.
  void reset(std::size_t size) {
    parent_.resize(size);
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// One of the same set; of a root itself.
  std::uint32_t parent(std::uint32_t i) const { return parent_[i]; }
  /// The root of the second one's set becomes that of both.
  void join(std::uint32_t a, std::uint32_t b) { set_parent(root(a), root(b)); }
  /// The same of two roots.
  void set_parent(std::uint32_t root, std::uint32_t parent) { parent_[root] = parent; }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace iota
