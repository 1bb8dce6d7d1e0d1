// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/bounds.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace iota::geometry {

inline Bounds joined(const Bounds& a, const Bounds& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}
/// The box around two places.
inline Bounds around(const Vec3& a, const Vec3& b) { return joined({a, a}, {b, b}); }
/// Farther on all sides, m.
inline Bounds grown(const Bounds& box, double by) {
  const Vec3 reach{by, by, by};
  return {box.low - reach, box.high + reach};
}
inline bool overlap(const Bounds& a, const Bounds& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}
/// The distance of two boxes, 0 if they overlap, m; and of a place, 0 inside.
double distance(const Bounds& a, const Bounds& b);
inline double distance(const Bounds& box, const Vec3& place) { return distance(box, {place, place}); }
/// The distance along a ray at which it comes into the box, 0 for a start inside; infinite if it does not. inverse: of
/// each component of its unit vector.
double entry(const Bounds& box, const Vec3& from, const Vec3& inverse);

/// A binary tree of boxes, for items that are searched by place (Ericson, Real-Time Collision Detection, 2005, chapter 6).
/// The box of an item that moves is fattened: the tree changes only when the item leaves it, and then only above that
/// item. It is built anew, in O(n log n), when moves have made it twice as large, or when most items are new. All
/// questions are about the fattened boxes; the order in which equally near items are visited depends on the history.
class BoxTree {
 public:
  /// Items are numbered as these boxes, which are not fattened. O(n log n).
  void build(std::span<const Bounds> boxes);
  /// @name Changes of items with any small numbers. Call `update` before the next question.
  ///@{
  /// A new item, or its box of now, which must be finite.
  void set(std::uint32_t item, const Bounds& box);
  void remove(std::uint32_t item);  ///< does nothing without such an item
  void update();
  ///@}
  std::size_t size() const { return size_; }

  /// Calls visit(item) with items by rising distance of their boxes, while that is at most `within`, m. visit returns
  /// the new limit.
  template <class Visit>
  void near(const Vec3& place, double within, Visit visit) const {
    search([&](const Bounds& box) { return distance(box, place); }, within, visit);
  }
  /// The same for a ray: by the distance at which it comes into a box. unit: its direction. width: boxes are so much larger on
  /// all sides, m, for a ball that goes along the ray.
  template <class Visit>
  void along(const Vec3& from, const Vec3& unit, double width, double within, Visit visit) const {
    const Vec3 inverse{1 / unit.x, 1 / unit.y, 1 / unit.z};
    search([&](const Bounds& box) { return entry(grown(box, width), from, inverse); }, within, visit);
  }
  /// Calls visit(item) with each item whose box overlaps this one.
  template <class Visit>
  void overlapping(const Bounds& box, Visit visit) const;
  /// Calls visit(item, item) with each two items whose boxes overlap, once.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    if (root_ != none) pairs_in(root_, visit);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr std::uint32_t most_height = 60;  ///< above that the tree is built anew
  struct Node {
    Bounds box;
    std::uint32_t parent = none, left = none;
    std::uint32_t right = none;  ///< of a leaf: its item
    std::uint32_t height = 0;    ///< 0: a leaf
    bool is_leaf() const { return height == 0; }
  };
  struct Leaf {
    Bounds box;
    std::uint32_t item;
  };
  void rebuild();
  std::uint32_t build_node(std::span<Leaf> leaves, std::uint32_t parent);
  std::uint32_t make_node(Node node);
  bool is_coarse() const;
  void insert(std::uint32_t leaf);
  void detach(std::uint32_t leaf);
  void refit_above(std::uint32_t node);

  template <class Measure, class Visit>
  void search(Measure measure, double within, Visit visit) const;
  template <class Visit>
  void pairs_in(std::uint32_t node, Visit& visit) const;
  template <class Visit>
  void pairs_between(std::uint32_t a, std::uint32_t b, Visit& visit) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_, waiting_;  ///< nodes; waiting: leaves that are not in the tree yet
  std::vector<std::uint32_t> leaf_of_;         ///< by item
  std::vector<Bounds> box_of_;                 ///< by item; set one after the other, while nodes are anywhere
  std::vector<Leaf> leaves_;                   ///< used by `rebuild`
  std::uint32_t root_ = none;
  std::size_t size_ = 0;                  ///< items, waiting ones too
  double extent_ = 0, built_extent_ = 0;  ///< of all nodes in the tree together; now, and when they were made
};

/// Half the sum of a box's edges: its measure in the tree.
inline double extent(const Bounds& box) {
  return (box.high.x - box.low.x) + (box.high.y - box.low.y) + (box.high.z - box.low.z);
}

// The nearer child is searched first; the other waits on a stack, with its distance.
template <class Measure, class Visit>
void BoxTree::search(Measure measure, double within, Visit visit) const {
  if (root_ == none) return;
  struct Waiting {
    std::uint32_t node;
    double distance;
  };
  Waiting stack[most_height + 2];
  std::size_t count = 0;
  constexpr double never = std::numeric_limits<double>::infinity();
  stack[count++] = {root_, measure(nodes_[root_].box)};
  while (count > 0) {
    auto [index, apart] = stack[--count];
    if (!(apart <= within && apart < never)) continue;
    for (const Node* node = &nodes_[index];;) {
      if (node->is_leaf()) {
        within = visit(node->right);
        break;
      }
      std::uint32_t first = node->left, second = node->right;
      double near = measure(nodes_[first].box), far = measure(nodes_[second].box);
      if (far < near) std::swap(first, second), std::swap(near, far);
      if (far <= within && far < never) stack[count++] = {second, far};
      if (!(near <= within && near < never)) break;
      node = &nodes_[first];
    }
  }
}

template <class Visit>
void BoxTree::overlapping(const Bounds& box, Visit visit) const {
  if (root_ == none) return;
  std::uint32_t stack[most_height + 2];
  std::size_t count = 0;
  stack[count++] = root_;
  while (count > 0) {
    const Node& node = nodes_[stack[--count]];
    if (!overlap(box, node.box)) continue;
    if (node.is_leaf())
      visit(node.right);
    else
      stack[count++] = node.right, stack[count++] = node.left;
  }
}

template <class Visit>
void BoxTree::pairs_in(std::uint32_t index, Visit& visit) const {
  const Node& node = nodes_[index];
  if (node.is_leaf()) return;
  pairs_in(node.left, visit), pairs_in(node.right, visit);
  pairs_between(node.left, node.right, visit);
}

template <class Visit>
void BoxTree::pairs_between(std::uint32_t a, std::uint32_t b, Visit& visit) const {
  const Node &one = nodes_[a], &other = nodes_[b];
  if (!overlap(one.box, other.box)) return;
  if (one.is_leaf() && other.is_leaf()) {
    visit(one.right, other.right);
  } else if (other.is_leaf() || (!one.is_leaf() && extent(one.box) >= extent(other.box))) {
    pairs_between(one.left, b, visit), pairs_between(one.right, b, visit);
  } else {
    pairs_between(a, other.left, visit), pairs_between(a, other.right, visit);
  }
}

}  // namespace iota::geometry
