// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/bounds.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace iota::geometry {

Bounds joined(const Bounds& a, const Bounds& b);
/// The distance of a place, 0 inside, m.
double distance(const Bounds& box, const Vec3& place);
/// The distance along a ray at which it comes into the box, 0 for a start inside; infinite if it does not. inverse: of
/// each component of its unit vector.
double entry(const Bounds& box, const Vec3& from, const Vec3& inverse);

/// A binary tree of boxes, for items that are searched by place (Ericson, Real-Time Collision Detection, 2005, chapter 6).
/// Items move: `refit` is cheap, but the tree becomes coarse when they leave their neighbors; it is then built anew.
class BoxTree {
 public:
  /// Items are numbered as these boxes. O(n log n).
  void build(std::span<const Bounds> boxes);
  /// The same items at other places. O(n).
  void refit(std::span<const Bounds> boxes);
  std::size_t size() const { return size_; }

  /// Calls visit(item) with items by rising distance of their boxes, while that is at most `within`, m. visit returns
  /// the new limit.
  template <class Visit>
  void near(const Vec3& place, double within, Visit visit) const {
    search([&](const Bounds& box) { return distance(box, place); }, within, visit);
  }
  /// The same for a ray: by the distance at which it comes into a box. unit: its direction.
  template <class Visit>
  void along(const Vec3& from, const Vec3& unit, double within, Visit visit) const {
    const Vec3 inverse{1 / unit.x, 1 / unit.y, 1 / unit.z};
    search([&](const Bounds& box) { return entry(box, from, inverse); }, within, visit);
  }

 private:
  struct Node {
    Bounds box;
    std::uint32_t right = 0;  ///< the second child; the first one follows its parent. 0: a leaf
    std::uint32_t item = 0;   ///< of a leaf
  };
  void build_node(std::span<const Bounds> boxes, std::span<std::uint32_t> items);
  void fit(std::span<const Bounds> boxes);
  double total_extent() const;

  template <class Measure, class Visit>
  void search(Measure measure, double within, Visit visit) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
  std::size_t size_ = 0;
  double built_extent_ = 0;  ///< of all nodes together when it was built
};

// The nearer child is searched first; the other waits on a stack, with its distance.
template <class Measure, class Visit>
void BoxTree::search(Measure measure, double within, Visit visit) const {
  if (nodes_.empty()) return;
  struct Waiting {
    std::uint32_t node;
    double distance;
  };
  Waiting stack[64];  // deeper than a tree of 2^32 items that is split in halves
  std::size_t count = 0;
  constexpr double never = std::numeric_limits<double>::infinity();
  stack[count++] = {0, measure(nodes_[0].box)};
  while (count > 0) {
    auto [index, apart] = stack[--count];
    if (!(apart <= within && apart < never)) continue;
    for (const Node* node = &nodes_[index];;) {
      if (node->right == 0) {
        within = visit(node->item);
        break;
      }
      std::uint32_t first = index + 1, second = node->right;
      double near = measure(nodes_[first].box), far = measure(nodes_[second].box);
      if (far < near) std::swap(first, second), std::swap(near, far);
      if (far <= within) stack[count++] = {second, far};
      if (!(near <= within && near < never)) break;
      index = first;
      node = &nodes_[index];
    }
  }
}

}  // namespace iota::geometry
