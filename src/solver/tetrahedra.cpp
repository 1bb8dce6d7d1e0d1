// SPDX-License-Identifier: Apache-2.0
#include "solver/tetrahedra.h"

#include "base/sort_unique.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iota::solver {

namespace {

/// Six times the volume, of the cube of the longest of three edges.
double volume_of(const std::array<std::uint32_t, 4>& nodes, std::span<const Vec3> x) {
  const Vec3 a = x[nodes[1]] - x[nodes[0]], b = x[nodes[2]] - x[nodes[0]], c = x[nodes[3]] - x[nodes[0]];
  const double longest = std::sqrt(std::max({dot(a, a), dot(b, b), dot(c, c)}));
  return longest > 0 ? dot(a, cross(b, c)) / (longest * longest * longest) : 0;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Kept for their capacity.
struct Scratch {
  std::vector<Edge> edges, nailed;  // nailed: a point, and a nailed neighbor
  std::vector<std::uint8_t> rows;   // of each point; a nail counts as one
  std::vector<std::uint8_t> is_nailed;
};

/// The rows with both signs between points that have three.
void list_edges(const Problem& problem, Scratch& s) {
  constexpr std::uint8_t needed = 3;
  const auto& pool = problem.pool_of<DistanceConstraint>();
  s.edges.clear(), s.rows.assign(problem.size(), 0), s.is_nailed.assign(problem.size(), 0);
  const auto add_row = [&](std::uint32_t node) { s.rows[node] = std::min<std::uint8_t>(s.rows[node] + 1, needed); };
  for (const auto& c : pool.items) add_row(c.nodes[0]), add_row(c.nodes[1]);
  for (const auto& nail : problem.items_of<AffineConstraint>())
    if (nail.is_nail()) s.is_nailed[nail.nodes[0]] = 1, add_row(nail.nodes[0]);
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const auto [a, b] = pool.items[k].nodes;
    if (s.rows[a] < needed || s.rows[b] < needed || (pool.has_laws() && pool.law(k)->is_one_sided())) continue;
    s.edges.push_back(std::minmax(a, b));
  }
}

/// Two nailed points of a body have no row between them: those with a common neighbor are given one.
void add_nailed_edges(Scratch& s) {
  s.nailed.clear();
  for (const auto& [a, b] : s.edges) {
    if (s.is_nailed[b] && !s.is_nailed[a]) s.nailed.push_back({a, b});
    if (s.is_nailed[a] && !s.is_nailed[b]) s.nailed.push_back({b, a});
  }
  std::sort(s.nailed.begin(), s.nailed.end());
  for (std::size_t i = 0; i < s.nailed.size(); ++i)
    for (std::size_t k = i + 1; k < s.nailed.size() && s.nailed[k].first == s.nailed[i].first; ++k)
      s.edges.push_back({s.nailed[i].second, s.nailed[k].second});
}

}  // namespace

void Tetrahedra::find(const Problem& problem) {
  constexpr std::ptrdiff_t most_neighbors = 64;  // a hub of many rods is no corner of a solid
  all_.clear();
  thread_local Scratch scratch;
  list_edges(problem, scratch);
  add_nailed_edges(scratch);
  std::vector<Edge>& edges = scratch.edges;
  sort_unique(edges);
  const auto have_row = [&](std::uint32_t a, std::uint32_t b) {
    return std::binary_search(edges.begin(), edges.end(), Edge(a, b));
  };
  for (auto first = edges.begin(), end = first; first != edges.end(); first = end) {
    const std::uint32_t a = first->first;
    end = std::find_if(first, edges.end(), [&](const Edge& edge) { return edge.first != a; });
    if (end - first < 3 || end - first > most_neighbors) continue;
    for (auto b = first; b != end; ++b)
      for (auto c = b + 1; c != end; ++c) {
        if (!have_row(b->second, c->second)) continue;
        for (auto d = c + 1; d != end; ++d)
          if (have_row(b->second, d->second) && have_row(c->second, d->second))
            all_.push_back({a, b->second, c->second, d->second});
      }
  }
}

bool Tetrahedra::are_mirrored(std::span<const Vec3> before, std::span<const Vec3> after) const {
  constexpr double flat = 1e-5;  // gaps of 1e-10 of an edge let a flat one bend so far
  return std::any_of(all_.begin(), all_.end(), [&](const auto& nodes) {
    const double volume = volume_of(nodes, before);
    if (std::abs(volume) < flat) return false;
    return volume_of(nodes, after) * std::copysign(1.0, volume) < -0.5 * std::abs(volume);
  });
}

}  // namespace iota::solver
