// SPDX-License-Identifier: Apache-2.0
#include "geometry/box_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace iota::geometry {
namespace {

constexpr double coarse = 2;  ///< times as large as when it was built: the tree is built anew

std::array<double, 3> numbers(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

Bounds joined(const Bounds& a, const Bounds& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

double distance(const Bounds& box, const Vec3& place) {
  const auto outside = [](double low, double high, double at) { return std::max({low - at, at - high, 0.0}); };
  return norm({outside(box.low.x, box.high.x, place.x), outside(box.low.y, box.high.y, place.y),
               outside(box.low.z, box.high.z, place.z)});
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
  size_ = boxes.size();
  nodes_.clear();
  nodes_.reserve(2 * size_);
  items_.resize(size_);
  std::iota(items_.begin(), items_.end(), 0u);
  if (size_ > 0) build_node(boxes, items_);
  fit(boxes);
  built_extent_ = total_extent();
}

void BoxTree::build_node(std::span<const Bounds> boxes, std::span<std::uint32_t> items) {
  const std::size_t at = nodes_.size();
  nodes_.push_back({{}, 0, items[0]});
  if (items.size() == 1) return;
  const auto middle = [&](std::uint32_t item, int axis) {
    return numbers(boxes[item].low)[axis] + numbers(boxes[item].high)[axis];
  };
  int widest = 0;
  double width = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] = std::ranges::minmax_element(
        items, [&](std::uint32_t a, std::uint32_t b) { return middle(a, axis) < middle(b, axis); });
    if (const double found = middle(*most, axis) - middle(*least, axis); found > width) width = found, widest = axis;
  }
  const std::size_t half = items.size() / 2;
  std::ranges::nth_element(items, items.begin() + static_cast<std::ptrdiff_t>(half),
                           [&](std::uint32_t a, std::uint32_t b) {
                             const double x = middle(a, widest), y = middle(b, widest);
                             return x != y ? x < y : a < b;
                           });
  build_node(boxes, items.first(half));
  nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
  build_node(boxes, items.subspan(half));
}

void BoxTree::refit(std::span<const Bounds> boxes) {
  fit(boxes);
  if (total_extent() > coarse * built_extent_) build(boxes);
}

void BoxTree::fit(std::span<const Bounds> boxes) {
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children come after their parents
    Node& node = nodes_[i];
    node.box = node.right == 0 ? boxes[node.item] : joined(nodes_[i + 1].box, nodes_[node.right].box);
  }
}

double BoxTree::total_extent() const {
  double sum = 0;
  for (const Node& node : nodes_) sum += norm(node.box.high - node.box.low);
  return sum;
}

}  // namespace iota::geometry
