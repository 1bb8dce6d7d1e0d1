// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_pattern.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <numeric>
#include <utility>

namespace iota::solver {

namespace {

using Edge = std::array<std::uint32_t, 2>;

/// Adjacency lists of an undirected graph, in order, without duplicates or loops, in one array.
struct Adjacency {
  std::vector<std::uint32_t> first, neighbors, cursor, unordered;

  // Taken in the order of nodes, the ends of edges come to the lists of their neighbors in order.
  void set(std::uint32_t n, std::span<const Edge> edges) {
    first.assign(n + 1, 0);
    for (auto [a, b] : edges)
      if (a != b) ++first[a + 1], ++first[b + 1];
    for (std::uint32_t i = 0; i < n; ++i) first[i + 1] += first[i];
    unordered.resize(first[n]), neighbors.resize(first[n]);
    cursor.assign(first.begin(), first.end() - 1);
    for (auto [a, b] : edges)
      if (a != b) unordered[cursor[a]++] = b, unordered[cursor[b]++] = a;
    cursor.assign(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
        std::uint32_t& end = cursor[unordered[k]];
        if (end == first[unordered[k]] || neighbors[end - 1] != i) neighbors[end++] = i;
      }
    std::uint32_t write = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t begin = std::exchange(first[i], write);
      for (std::uint32_t k = begin; k < cursor[i]; ++k) neighbors[write++] = neighbors[k];
    }
    first[n] = write;
  }
};

/// The neighbors of each node, in order; lists grow by fill. They are cleaned of eliminated ones only when they are read,
/// so that a hub with a thousand leaves costs O(1) a leaf.
class EliminationGraph {
 public:
  void set(std::uint32_t n, std::span<const Edge> edges) {
    graph_.set(n, edges);
    lists_.resize(n), eliminated_.assign(n, 0);
    for (std::uint32_t i = 0; i < n; ++i)
      lists_[i] = {graph_.first[i], graph_.first[i + 1] - graph_.first[i], graph_.first[i + 1] - graph_.first[i]};
    live_ = graph_.neighbors.size();
  }
  std::uint32_t degree(std::uint32_t node) const { return lists_[node].size; }  ///< before any elimination
  bool is_eliminated(std::uint32_t node) const { return eliminated_[node]; }

  /// Puts the remaining neighbors into `front`.
  void eliminate(std::uint32_t node, std::vector<std::uint32_t>& front) {
    eliminated_[node] = 1;
    front.clear();
    for (const std::uint32_t other : of(node))
      if (!eliminated_[other]) front.push_back(other);
    live_ -= lists_[node].room, lists_[node] = {};
  }
  /// Couples a node with those of a front. Returns its degree.
  std::uint32_t couple(std::uint32_t node, std::span<const std::uint32_t> front) {
    const auto list = of(node);
    if (merged_.size() < list.size() + front.size()) merged_.resize(2 * (list.size() + front.size()));
    std::uint32_t size = 0;
    const auto add = [&](std::uint32_t other) {
      merged_[size] = other;
      size += other != node && !eliminated_[other];
    };
    std::size_t i = 0, j = 0;
    while (i < list.size() && j < front.size()) {
      const std::uint32_t a = list[i], b = front[j];
      add(std::min(a, b));
      i += a <= b, j += b <= a;
    }
    for (; i < list.size(); ++i) add(list[i]);
    for (; j < front.size(); ++j) add(front[j]);
    if (size > lists_[node].room) move_to_end(node, size);
    lists_[node].size = size;
    std::copy_n(merged_.begin(), size, graph_.neighbors.begin() + lists_[node].begin);
    return size;
  }

 private:
  struct List {
    std::uint32_t begin = 0, size = 0, room = 0;
  };
  std::span<const std::uint32_t> of(std::uint32_t node) const {
    return {graph_.neighbors.data() + lists_[node].begin, lists_[node].size};
  }
  void move_to_end(std::uint32_t node, std::uint32_t room) {
    live_ -= lists_[node].room, lists_[node] = {};
    if (graph_.neighbors.size() > 2 * live_ + room) close_gaps();
    lists_[node] = {static_cast<std::uint32_t>(graph_.neighbors.size()), 0, room}, live_ += room;
    graph_.neighbors.resize(graph_.neighbors.size() + room);
  }
  void close_gaps() {
    packed_.clear();
    for (List& list : lists_) {
      const auto first = graph_.neighbors.begin() + list.begin;
      list.begin = static_cast<std::uint32_t>(packed_.size()), list.room = list.size;
      packed_.insert(packed_.end(), first, first + list.size);
    }
    packed_.swap(graph_.neighbors);
    live_ = graph_.neighbors.size();
  }

  Adjacency graph_;          // with room for lists that have grown behind it
  std::vector<List> lists_;  // of each node
  std::size_t live_ = 0;     // room of the lists
  std::vector<std::uint32_t> merged_, packed_;
  std::vector<std::uint8_t> eliminated_;
};

/// The same for up to 64 * words nodes, as a matrix of bits: islands of some bodies are ordered all the time.
template <std::size_t words>
class EliminationBits {
 public:
  void set(std::uint32_t n, std::span<const Edge> edges) {
    rows_.assign(n, {});
    remaining_ = {};
    for (std::uint32_t i = 0; i < n; ++i) remaining_[i / 64] |= bit(i);
    for (auto [a, b] : edges)
      if (a != b) rows_[a][b / 64] |= bit(b), rows_[b][a / 64] |= bit(a);
  }
  std::uint32_t degree(std::uint32_t node) const {
    std::uint32_t sum = 0;
    for (std::size_t w = 0; w < words; ++w)
      sum += static_cast<std::uint32_t>(std::popcount(rows_[node][w] & remaining_[w]));
    return sum;
  }
  bool is_eliminated(std::uint32_t node) const { return (remaining_[node / 64] & bit(node)) == 0; }
  void eliminate(std::uint32_t node, std::vector<std::uint32_t>& front) {
    remaining_[node / 64] &= ~bit(node);
    front.clear();
    for (std::uint32_t w = 0; w < words; ++w) {
      front_[w] = rows_[node][w] & remaining_[w];
      for (std::uint64_t left = front_[w]; left != 0; left &= left - 1)
        front.push_back(64 * w + static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }
  /// Couples a node with the front of the latest elimination.
  std::uint32_t couple(std::uint32_t node, std::span<const std::uint32_t>) {
    for (std::size_t w = 0; w < words; ++w) rows_[node][w] |= front_[w];
    rows_[node][node / 64] &= ~bit(node);
    return degree(node);
  }

 private:
  using Bits = std::array<std::uint64_t, words>;
  static std::uint64_t bit(std::uint32_t node) { return std::uint64_t{1} << node % 64; }
  std::vector<Bits> rows_;
  Bits remaining_{}, front_{};
};

// An elimination graph with explicit fill. Leaves are taken first in, first out: the ends of a chain alternate, so that
// successive eliminations do not wait for each other's divisions (512 rods: a step takes 0.23 instead of 0.27 us a
// link). Others are taken last in, first out: a sixth less work in a net of 100 x 100 than the reverse. The degree is
// counted exactly.
//
// The nodes from `own` to n - 1, the surroundings of a part, are not eliminated. Gives up, and returns nothing, if
// eliminations couple more than `most_pairs` pairs of neighbors.
template <class Graph>
void minimum_degree_order_of(std::uint32_t n, std::uint32_t own, std::span<const Edge> edges, std::size_t most_pairs,
                             std::vector<std::uint32_t>& order) {
  struct Queue {
    std::vector<std::uint32_t> nodes;
    std::size_t next = 0;
  };
  struct Room {
    Graph graph;
    std::vector<std::uint32_t> degree, front;
    std::vector<Queue> buckets;  // by degree
  };
  thread_local Room kept;
  Room passing;
  auto& [graph, degree, front, buckets] = n <= most_kept_nodes ? kept : passing;
  graph.set(n, edges);
  degree.resize(n);
  for (Queue& queue : buckets) queue.nodes.clear(), queue.next = 0;
  const auto push = [&](std::uint32_t node) {
    if (degree[node] >= buckets.size()) buckets.resize(degree[node] + 1);
    buckets[degree[node]].nodes.push_back(node);
  };
  for (std::uint32_t i = 0; i < n; ++i) degree[i] = graph.degree(i);
  for (std::uint32_t i = n; i-- > 0;)
    if (i < own && degree[i] > 1) push(i);  // taken from the back
  for (std::uint32_t i = 0; i < n; ++i)
    if (i < own && degree[i] <= 1) push(i);

  order.clear();
  order.reserve(own);
  std::size_t lowest = 0, pairs = 0;
  while (order.size() < own) {
    while (buckets[lowest].next == buckets[lowest].nodes.size()) ++lowest;
    Queue& queue = buckets[lowest];
    const std::uint32_t node = lowest <= 1 ? queue.nodes[queue.next++] : queue.nodes.back();
    if (lowest > 1) queue.nodes.pop_back();
    if (graph.is_eliminated(node) || degree[node] != lowest) continue;  // an outdated entry of the queue
    order.push_back(node);
    graph.eliminate(node, front);
    pairs += front.size() * (front.size() + 1) / 2;
    if (pairs > most_pairs) return order.clear();

    for (const std::uint32_t neighbor : front) {
      degree[neighbor] = front.size() == 1 ? degree[neighbor] - 1 : graph.couple(neighbor, front);
      if (neighbor >= own) continue;
      push(neighbor);
      lowest = std::min<std::size_t>(lowest, degree[neighbor]);
    }
  }
}

void minimum_degree_order(std::uint32_t n, std::uint32_t own, std::span<const Edge> edges, std::size_t most_pairs,
                          std::vector<std::uint32_t>& order) {
  if (n <= 64) return minimum_degree_order_of<EliminationBits<1>>(n, own, edges, most_pairs, order);
  if (n <= 256) return minimum_degree_order_of<EliminationBits<4>>(n, own, edges, most_pairs, order);
  minimum_degree_order_of<EliminationGraph>(n, own, edges, most_pairs, order);
}

/// Nested dissection by places (George 1973): the smallest of three planes' separators is eliminated after both sides,
/// which are cut in the same way. Parts of some tens of nodes are ordered by minimum degree, among the nodes around
/// them (Pellegrini, Roman, Amestoy 2000: otherwise a tenth more fill).
class Dissection {
 public:
  /// Puts all nodes into `order`.
  void find_order(std::uint32_t n, std::span<const Edge> edges, std::span<const Vec3> places,
                  std::vector<std::uint32_t>& order) {
    graph_.set(n, edges);
    places_ = places;
    number_.assign(n, none), is_separating_.assign(n, 0);
    order.resize(n);
    std::iota(order.begin(), order.end(), 0u);
    cut(order);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr std::size_t small_part = 100;

  std::span<const std::uint32_t> neighbors(std::uint32_t node) const {
    return {graph_.neighbors.data() + graph_.first[node], graph_.first[node + 1] - graph_.first[node]};
  }
  double place(std::uint32_t node, int axis) const {
    const Vec3& x = places_[node];
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
  }

  void order_part(std::span<std::uint32_t> part) {
    const auto own = static_cast<std::uint32_t>(part.size());
    around_.assign(part.begin(), part.end()), edges_.clear();
    for (std::uint32_t i = 0; i < own; ++i) number_[part[i]] = i;
    for (std::uint32_t i = 0; i < own; ++i)
      for (const std::uint32_t other : neighbors(part[i])) {
        if (number_[other] == none)
          number_[other] = static_cast<std::uint32_t>(around_.size()), around_.push_back(other);
        if (number_[other] > i) edges_.push_back({i, number_[other]});
      }
    for (const std::uint32_t node : around_) number_[node] = none;
    minimum_degree_order(static_cast<std::uint32_t>(around_.size()), own, edges_, ~0ull, part_order_);
    for (std::uint32_t i = 0; i < own; ++i) part[i] = around_[part_order_[i]];
  }

  // The parts are in place: left, right, separator.
  void cut(std::span<std::uint32_t> part) {
    if (part.size() <= small_part) return order_part(part);
    bool found = false;
    for (const int axis : {0, 1, 2}) {
      const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
      std::nth_element(part.begin(), middle, part.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(place(a, axis), a) < std::pair(place(b, axis), b);
      });
      for (auto node = part.begin(); node != part.end(); ++node) number_[*node] = node < middle ? 0 : 1;
      one_side_.clear(), other_side_.clear();
      for (const std::uint32_t node : part) {
        const std::uint32_t across = 1 - number_[node];
        const auto near = neighbors(node);
        if (std::none_of(near.begin(), near.end(), [&](std::uint32_t other) { return number_[other] == across; }))
          continue;
        (across == 1 ? one_side_ : other_side_).push_back(node);
      }
      const auto& smaller = one_side_.size() <= other_side_.size() ? one_side_ : other_side_;
      if (!found || smaller.size() < separator_.size()) {
        found = true;
        separator_ = smaller;
        for (const std::uint32_t node : separator_) is_separating_[node] = 1;
        left_.clear(), right_.clear();
        for (const std::uint32_t node : part)
          if (!is_separating_[node]) (number_[node] == 0 ? left_ : right_).push_back(node);
        for (const std::uint32_t node : separator_) is_separating_[node] = 0;
      }
      for (const std::uint32_t node : part) number_[node] = none;
    }
    if (left_.empty() || right_.empty()) return order_part(part);  // a complete graph
    std::sort(separator_.begin(), separator_.end());
    const std::size_t left = left_.size(), right = right_.size();
    auto next = std::copy(left_.begin(), left_.end(), part.begin());
    next = std::copy(right_.begin(), right_.end(), next);
    std::copy(separator_.begin(), separator_.end(), next);
    cut(part.first(left)), cut(part.subspan(left, right));
  }

  Adjacency graph_;
  std::span<const Vec3> places_;
  std::vector<std::uint32_t> number_;  // none, except for nodes of the present part
  std::vector<std::uint8_t> is_separating_;
  std::vector<std::uint32_t> separator_, left_, right_, one_side_, other_side_;  // of the present part
  std::vector<std::uint32_t> around_, part_order_;
  std::vector<Edge> edges_;
};

}  // namespace

// Up to some hundred pairs a node (chains, trees, bodies, nets of a thousand knots) minimum degree makes a tenth to a third
// less fill and takes a millisecond for a thousand nodes. Beyond, its lists grow with the fill: a net of 223 x 223 takes 2.4 s
// and 126 million pairs, dissection 0.4 s and 94 million; a lattice of 14^3 with diagonals 0.6 s and 44, 0.05 s and 20.
void find_elimination_order(std::uint32_t n, std::span<const std::array<std::uint32_t, 2>> edges,
                            std::span<const Vec3> places, std::vector<std::uint32_t>& order) {
  constexpr std::size_t most_pairs = 300;  // a node
  const std::size_t limit = places.size() == n ? most_pairs * n : ~std::size_t{0};
  minimum_degree_order(n, n, edges, limit, order);
  if (order.size() == n) return;
  thread_local Dissection kept;
  if (n <= most_kept_nodes)
    kept.find_order(n, edges, places, order);
  else
    Dissection().find_order(n, edges, places, order);
}

}  // namespace iota::solver
