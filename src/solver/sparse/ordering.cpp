// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_pattern.h"

#include <algorithm>

namespace iota::solver {

namespace {

/// Adjacency lists of an undirected graph without duplicates or loops, in one array.
struct Adjacency {
  std::vector<std::uint32_t> first, neighbors;

  Adjacency(std::uint32_t n, std::span<const std::array<std::uint32_t, 2>> edges) : first(n + 1, 0) {
    for (auto [a, b] : edges)
      if (a != b) ++first[a + 1], ++first[b + 1];
    for (std::uint32_t i = 0; i < n; ++i) first[i + 1] += first[i];
    neighbors.resize(first[n]);
    std::vector<std::uint32_t> cursor(first.begin(), first.end() - 1);
    for (auto [a, b] : edges)
      if (a != b) neighbors[cursor[a]++] = b, neighbors[cursor[b]++] = a;
    std::uint32_t write = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto begin = neighbors.begin() + first[i], end = neighbors.begin() + first[i + 1];
      std::sort(begin, end);
      const auto unique_end = std::unique(begin, end);
      first[i] = write;
      write = static_cast<std::uint32_t>(std::copy(begin, unique_end, neighbors.begin() + write) - neighbors.begin());
    }
    first[n] = write;
  }
};

}  // namespace

// An elimination graph with explicit fill. Leaves are taken first come, first served: the ends of a chain take turns, so
// that successive eliminations do not wait for each other's divisions (512 rods: a step takes 0.23 instead of 0.27 us a
// link). Others are taken last come, first served: a sixth less work in a net of 100 x 100 than the other way. Lists are
// cleaned of eliminated neighbors only when they are read, so that a hub with a thousand leaves costs O(1) a leaf; the
// degree itself is counted exactly.
std::vector<std::uint32_t> minimum_degree_order(std::uint32_t n, std::span<const std::array<std::uint32_t, 2>> edges) {
  const Adjacency graph(n, edges);
  std::vector<std::uint32_t> degree(n);
  std::vector<std::vector<std::uint32_t>> filled(n);  // lists that fill has changed; empty: still the graph's own
  std::vector<std::uint8_t> eliminated(n, 0);
  struct Queue {
    std::vector<std::uint32_t> nodes;
    std::size_t next = 0;
  };
  std::vector<Queue> buckets;  // by degree
  const auto push = [&](std::uint32_t node) {
    if (degree[node] >= buckets.size()) buckets.resize(degree[node] + 1);
    buckets[degree[node]].nodes.push_back(node);
  };
  for (std::uint32_t i = 0; i < n; ++i) degree[i] = graph.first[i + 1] - graph.first[i];
  for (std::uint32_t i = n; i-- > 0;)
    if (degree[i] > 1) push(i);  // taken from the back
  for (std::uint32_t i = 0; i < n; ++i)
    if (degree[i] <= 1) push(i);

  std::vector<std::uint32_t> order, front, merged;
  order.reserve(n);
  std::size_t lowest = 0;
  while (order.size() < n) {
    while (buckets[lowest].next == buckets[lowest].nodes.size()) ++lowest;
    Queue& queue = buckets[lowest];
    const std::uint32_t node = lowest <= 1 ? queue.nodes[queue.next++] : queue.nodes.back();
    if (lowest > 1) queue.nodes.pop_back();
    if (eliminated[node] || degree[node] != lowest) continue;  // an outdated place in the queue
    eliminated[node] = 1;
    order.push_back(node);

    front.clear();
    const auto collect = [&](auto begin, auto end) {
      for (auto it = begin; it != end; ++it)
        if (!eliminated[*it]) front.push_back(*it);
    };
    if (filled[node].empty())
      collect(graph.neighbors.begin() + graph.first[node], graph.neighbors.begin() + graph.first[node + 1]);
    else
      collect(filled[node].begin(), filled[node].end());
    filled[node] = {};

    for (const std::uint32_t neighbor : front) {
      if (front.size() == 1) {
        --degree[neighbor];
      } else {
        merged.clear();
        const auto add_list = [&](auto begin, auto end) {
          std::set_union(begin, end, front.begin(), front.end(), std::back_inserter(merged));
        };
        if (filled[neighbor].empty())
          add_list(graph.neighbors.begin() + graph.first[neighbor],
                   graph.neighbors.begin() + graph.first[neighbor + 1]);
        else
          add_list(filled[neighbor].begin(), filled[neighbor].end());
        std::erase_if(merged, [&](std::uint32_t other) { return other == neighbor || eliminated[other]; });
        filled[neighbor] = merged;
        degree[neighbor] = static_cast<std::uint32_t>(merged.size());
      }
      push(neighbor);
      lowest = std::min<std::size_t>(lowest, degree[neighbor]);
    }
  }
  return order;
}

}  // namespace iota::solver
