// SPDX-License-Identifier: Apache-2.0
#include "geometry/box_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace iota::geometry {
namespace {

constexpr double coarse = 2;    ///< times as large as when its nodes were made: the tree is built anew
constexpr double margin = 0.2;  ///< of a fattened box on each side, in its longest edge
constexpr double many = 0.5;    ///< share of new items from which the tree is built anew

std::array<double, 3> numbers(const Vec3& v) { return {v.x, v.y, v.z}; }

Bounds fattened(const Bounds& box) {
  const Vec3 edges = box.high - box.low;
  const double by = margin * std::max({edges.x, edges.y, edges.z});
  return {box.low - Vec3{by, by, by}, box.high + Vec3{by, by, by}};
}

bool contains(const Bounds& box, const Bounds& inner) {
  return box.low.x <= inner.low.x && box.low.y <= inner.low.y && box.low.z <= inner.low.z &&
         inner.high.x <= box.high.x && inner.high.y <= box.high.y && inner.high.z <= box.high.z;
}

bool operator==(const Bounds& a, const Bounds& b) { return a.low == b.low && a.high == b.high; }

}  // namespace

double distance(const Bounds& a, const Bounds& b) {
  const auto apart = [&](double Vec3::* axis) {
    return std::max({a.low.*axis - b.high.*axis, b.low.*axis - a.high.*axis, 0.0});
  };
  return norm({apart(&Vec3::x), apart(&Vec3::y), apart(&Vec3::z)});
}

// Slabs (Ericson, section 5.3.3). A ray in the plane of a face has 0 times infinity, which the comparisons below ignore.
double entry(const Bounds& box, const Vec3& from, const Vec3& inverse) {
  const auto low = numbers(box.low), high = numbers(box.high), start = numbers(from), factor = numbers(inverse);
  double in = 0, out = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (low[axis] - start[axis]) * factor[axis], b = (high[axis] - start[axis]) * factor[axis];
    if (std::isnan(a) || std::isnan(b)) continue;
    in = std::max(in, std::min(a, b));
    out = std::min(out, std::max(a, b));
  }
  return in <= out ? in : std::numeric_limits<double>::infinity();
}

void BoxTree::build(std::span<const Bounds> boxes) {
  leaves_.clear();
  for (const Bounds& box : boxes) leaves_.push_back({box, static_cast<std::uint32_t>(leaves_.size())});
  rebuild();
  leaves_ = {};
}

void BoxTree::set(std::uint32_t item, const Bounds& box) {
  if (leaf_of_.size() <= item) leaf_of_.resize(item + std::size_t{1}, none), box_of_.resize(item + std::size_t{1});
  Bounds& known = box_of_[item];
  std::uint32_t& leaf = leaf_of_[item];
  if (leaf == none) {
    known = fattened(box);
    leaf = make_node({.box = known, .right = item});
    waiting_.push_back(leaf);
    ++size_;
    return;
  }
  // A box that has become much smaller than its own would be found from too far away.
  constexpr double too_fat = 2 * (1 + 2 * margin * 3);
  if (contains(known, box) && extent(known) <= too_fat * extent(box)) return;
  known = fattened(box);
  Node& node = nodes_[leaf];
  const bool is_in_tree = node.parent != none || leaf == root_;
  const double before = extent(node.box);
  node.box = known;
  if (!is_in_tree) return;
  extent_ += extent(node.box) - before;
  refit_above(leaf);
}

void BoxTree::remove(std::uint32_t item) {
  if (item >= leaf_of_.size() || leaf_of_[item] == none) return;
  const std::uint32_t leaf = std::exchange(leaf_of_[item], none);
  --size_;
  if (nodes_[leaf].parent == none && leaf != root_)
    std::erase(waiting_, leaf);
  else
    detach(leaf);
  free_.push_back(leaf);
}

bool BoxTree::is_coarse() const {
  return extent_ > coarse * built_extent_ || (root_ != none && nodes_[root_].height > most_height);
}

void BoxTree::update() {
  if (static_cast<double>(waiting_.size()) < many * static_cast<double>(size_)) {
    for (; !waiting_.empty() && !is_coarse(); waiting_.pop_back()) insert(waiting_.back());
    if (!is_coarse()) return;
  } else if (size_ == 0) {
    return;
  }
  leaves_.clear();
  for (std::uint32_t item = 0; item < leaf_of_.size(); ++item)
    if (leaf_of_[item] != none) leaves_.push_back({nodes_[leaf_of_[item]].box, item});
  rebuild();
}

void BoxTree::rebuild() {
  std::uint32_t slots = 0;
  for (const Leaf& leaf : leaves_) slots = std::max(slots, leaf.item + 1);
  nodes_.clear(), free_.clear(), waiting_.clear();
  nodes_.reserve(2 * leaves_.size());
  leaf_of_.assign(slots, none), box_of_.resize(slots);
  size_ = leaves_.size();
  extent_ = 0;
  root_ = size_ > 0 ? build_node(leaves_, none) : none;
  built_extent_ = extent_;
}

std::uint32_t BoxTree::build_node(std::span<Leaf> leaves, std::uint32_t parent) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({.parent = parent});
  if (leaves.size() == 1) {
    nodes_[at].box = leaves[0].box, nodes_[at].right = leaves[0].item;
    leaf_of_[leaves[0].item] = at, box_of_[leaves[0].item] = leaves[0].box;
    extent_ += extent(nodes_[at].box);
    return at;
  }
  const auto middle = [](const Leaf& leaf, int axis) {
    return numbers(leaf.box.low)[axis] + numbers(leaf.box.high)[axis];
  };
  int widest = 0;
  double width = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] = std::ranges::minmax_element(
        leaves, [&](const Leaf& a, const Leaf& b) { return middle(a, axis) < middle(b, axis); });
    if (const double found = middle(*most, axis) - middle(*least, axis); found > width) width = found, widest = axis;
  }
  const std::size_t half = leaves.size() / 2;
  std::ranges::nth_element(leaves, leaves.begin() + static_cast<std::ptrdiff_t>(half),
                           [&](const Leaf& a, const Leaf& b) {
                             const double x = middle(a, widest), y = middle(b, widest);
                             return x != y ? x < y : a.item < b.item;
                           });
  const std::uint32_t left = build_node(leaves.first(half), at), right = build_node(leaves.subspan(half), at);
  nodes_[at].left = left, nodes_[at].right = right;
  nodes_[at].height = 1 + std::max(nodes_[left].height, nodes_[right].height);
  nodes_[at].box = joined(nodes_[left].box, nodes_[right].box);
  extent_ += extent(nodes_[at].box);
  return at;
}

std::uint32_t BoxTree::make_node(Node node) {
  if (free_.empty()) {
    nodes_.push_back(node);
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }
  const std::uint32_t at = free_.back();
  free_.pop_back();
  nodes_[at] = node;
  return at;
}

// Goes down to where the boxes grow least, as the dynamic tree of Box2D without its rotations.
void BoxTree::insert(std::uint32_t leaf) {
  const Bounds box = nodes_[leaf].box;
  extent_ += extent(box), built_extent_ += extent(box);
  if (root_ == none) {
    root_ = leaf;
    return;
  }
  std::uint32_t beside = root_;
  while (!nodes_[beside].is_leaf()) {
    const Node& node = nodes_[beside];
    const double whole = extent(joined(node.box, box)), growth = whole - extent(node.box);
    const auto cost = [&](std::uint32_t child) {
      const Bounds& own = nodes_[child].box;
      return extent(joined(own, box)) + growth - (nodes_[child].is_leaf() ? 0 : extent(own));
    };
    const double left = cost(node.left), right = cost(node.right);
    if (whole < left && whole < right) break;
    beside = left <= right ? node.left : node.right;
  }
  const std::uint32_t above = nodes_[beside].parent;
  const std::uint32_t parent = make_node({.box = joined(nodes_[beside].box, box),
                                          .parent = above,
                                          .left = beside,
                                          .right = leaf,
                                          .height = nodes_[beside].height + 1});
  nodes_[beside].parent = nodes_[leaf].parent = parent;
  if (above == none)
    root_ = parent;
  else
    (nodes_[above].left == beside ? nodes_[above].left : nodes_[above].right) = parent;
  extent_ += extent(nodes_[parent].box), built_extent_ += extent(nodes_[parent].box);
  refit_above(parent);
}

void BoxTree::detach(std::uint32_t leaf) {
  const std::uint32_t parent = nodes_[leaf].parent;
  if (parent == none) {
    root_ = none;
    extent_ = built_extent_ = 0;
    return;
  }
  const double gone = extent(nodes_[leaf].box) + extent(nodes_[parent].box);
  if (extent_ > 0) built_extent_ *= std::max(0.0, 1 - gone / extent_);
  extent_ -= gone;
  const std::uint32_t above = nodes_[parent].parent;
  const std::uint32_t beside = nodes_[parent].left == leaf ? nodes_[parent].right : nodes_[parent].left;
  nodes_[beside].parent = above;
  if (above == none)
    root_ = beside;
  else
    (nodes_[above].left == parent ? nodes_[above].left : nodes_[above].right) = beside;
  free_.push_back(parent);
  refit_above(beside);
}

void BoxTree::refit_above(std::uint32_t index) {
  for (std::uint32_t at = nodes_[index].parent; at != none; at = nodes_[at].parent) {
    Node& node = nodes_[at];
    const Bounds box = joined(nodes_[node.left].box, nodes_[node.right].box);
    const std::uint32_t height = 1 + std::max(nodes_[node.left].height, nodes_[node.right].height);
    if (box == node.box && height == node.height) return;
    extent_ += extent(box) - extent(node.box);
    node.box = box, node.height = height;
  }
}

}  // namespace iota::geometry
