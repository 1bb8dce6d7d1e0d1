// SPDX-License-Identifier: Apache-2.0
// Quickhull (Barber, Dobkin, Huhdanpaa 1996) in three dimensions: a hull that grows by the point farthest outside one of
// its facets. Facets visible from it are removed along a closed horizon, which is joined to the point.
#include <iota/shapes.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace iota {

namespace {

constexpr std::uint32_t none = 0xffffffff;
/// As a part of the extent: points nearer than this to a facet count as points on it. The value is well above round-off and
/// too small to be seen.
constexpr double thickness = 1e-11;

struct Facet {
  std::array<std::uint32_t, 3> vertices{};
  std::array<std::uint32_t, 3> neighbors{none, none, none};  ///< across the edge from vertex i to vertex i + 1
  Vec3 normal;
  double offset = 0;
  std::vector<std::uint32_t> outside;  ///< points above it; each outer point is listed at one facet
  bool gone = false;
};

struct HorizonEdge {
  std::uint32_t from, to, beyond;  ///< beyond: the facet that stays
};

class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) : points_(points) {
    for (const Vec3& p : points_) extent_ = std::max(extent_, norm(p - points_[0]));
    make_simplex();
    for (std::uint32_t f = 0; f < facets_.size(); ++f)  // new ones are appended and processed too
      if (!facets_[f].gone && !facets_[f].outside.empty()) grow(f);
  }

  Mesh mesh() const {
    Mesh mesh;
    std::vector<std::uint32_t> number(points_.size(), none);
    for (const Facet& f : facets_)
      if (!f.gone)
        for (const std::uint32_t v : f.vertices) number[v] = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (number[i] == none) continue;
      number[i] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(points_[i]);
    }
    for (const Facet& f : facets_)
      if (!f.gone) mesh.triangles.push_back({number[f.vertices[0]], number[f.vertices[1]], number[f.vertices[2]]});
    return mesh;
  }

 private:
  double height(const Facet& f, std::uint32_t point) const { return dot(f.normal, points_[point]) - f.offset; }
  bool sees(std::uint32_t point, const Facet& f) const { return height(f, point) > thickness * extent_; }

  /// The point of the largest measure. Among equals the one farthest from the first point, which is a corner and not
  /// inside an edge or face, since a convex function is largest at a corner.
  template <class Measure>
  std::uint32_t farthest(std::span<const std::uint32_t> among, Measure measure) const {
    double most = 0, reach = -1;
    for (const std::uint32_t i : among) most = std::max(most, measure(points_[i]));
    std::uint32_t best = among.front();
    for (const std::uint32_t i : among) {
      if (measure(points_[i]) < most - thickness * extent_) continue;
      if (const double r = norm(points_[i] - points_[0]); r > reach) reach = r, best = i;
    }
    return best;
  }
  void require_extent(double measure, const char* what) const {
    if (measure > 1e-9 * extent_) return;
    throw std::invalid_argument(std::string("convex_hull: all points are ") + what + ", which encloses no volume");
  }

  std::uint32_t add_facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Facet f;
    f.vertices = {a, b, c};
    const Vec3 n = cross(points_[b] - points_[a], points_[c] - points_[a]);
    f.normal = (1 / norm(n)) * n;
    f.offset = dot(f.normal, points_[a]);
    facets_.push_back(std::move(f));
    return static_cast<std::uint32_t>(facets_.size() - 1);
  }

  void make_simplex() {
    std::vector<std::uint32_t> all(points_.size());
    std::iota(all.begin(), all.end(), 0u);
    if (!(extent_ > 0)) require_extent(0, "at one place");
    const std::uint32_t a = farthest(all, [&](const Vec3& p) { return norm(p - points_[0]); });
    const Vec3 origin = points_[a];
    const std::uint32_t b = farthest(all, [&](const Vec3& p) { return norm(p - origin); });
    const Vec3 along = (1 / norm(points_[b] - origin)) * (points_[b] - origin);
    const auto off_line = [&](const Vec3& p) { return norm(cross(along, p - origin)); };
    const std::uint32_t c = farthest(all, off_line);
    require_extent(off_line(points_[c]), "on one line");
    Vec3 normal = cross(along, points_[c] - origin);
    normal = (1 / norm(normal)) * normal;
    const auto off_plane = [&](const Vec3& p) { return std::abs(dot(normal, p - origin)); };
    const std::uint32_t d = farthest(all, off_plane);
    require_extent(off_plane(points_[d]), "in one plane");
    std::uint32_t first = a, second = b;
    if (dot(normal, points_[d] - origin) > 0) std::swap(first, second);  // d below the first facet
    add_facet(first, second, c);
    // The other three are at its edges; each of them shares an edge at d with the previous and the next one.
    for (int i = 0; i < 3; ++i) {
      const auto [from, to] = std::pair{facets_[0].vertices[i], facets_[0].vertices[(i + 1) % 3]};
      const std::uint32_t side = add_facet(to, from, d);
      facets_[side].neighbors = {0, static_cast<std::uint32_t>(1 + (i + 2) % 3),
                                 static_cast<std::uint32_t>(1 + (i + 1) % 3)};
      facets_[0].neighbors[i] = side;
    }
    hand_out(all, 0);
  }

  /// Assigns each point to a facet from `first` on that is visible from it, if any; the others are inside.
  void hand_out(std::span<const std::uint32_t> points, std::size_t first) {
    for (const std::uint32_t p : points)
      for (std::size_t f = first; f < facets_.size(); ++f)
        if (sees(p, facets_[f])) {
          facets_[f].outside.push_back(p);
          break;
        }
  }

  void grow(std::uint32_t start) {
    const Facet& base = facets_[start];
    const std::uint32_t apex = farthest(base.outside, [&](const Vec3& p) { return dot(base.normal, p) - base.offset; });
    std::vector<HorizonEdge> horizon;
    std::vector<std::uint32_t> orphans;
    cut_away(start, apex, horizon, orphans);

    const std::size_t first = facets_.size();
    for (const HorizonEdge& edge : horizon) {
      const std::uint32_t made = add_facet(edge.from, edge.to, apex);
      facets_[made].neighbors[0] = edge.beyond;
      Facet& beyond = facets_[edge.beyond];
      for (int i = 0; i < 3; ++i)
        if (beyond.vertices[i] == edge.to && beyond.vertices[(i + 1) % 3] == edge.from) beyond.neighbors[i] = made;
    }
    for (std::size_t f = first; f < facets_.size(); ++f)  // the horizon is one closed loop
      for (std::size_t g = first; g < facets_.size(); ++g)
        if (facets_[g].vertices[0] == facets_[f].vertices[1]) {
          facets_[f].neighbors[1] = static_cast<std::uint32_t>(g);
          facets_[g].neighbors[2] = static_cast<std::uint32_t>(f);
        }
    hand_out(orphans, first);
  }

  /// Removes all facets visible from the apex, found by going from one to the next.
  void cut_away(std::uint32_t start, std::uint32_t apex, std::vector<HorizonEdge>& horizon,
                std::vector<std::uint32_t>& orphans) {
    std::vector<std::uint32_t> seen{start};
    facets_[start].gone = true;
    for (std::size_t next = 0; next < seen.size(); ++next) {
      Facet& f = facets_[seen[next]];
      orphans.insert(orphans.end(), f.outside.begin(), f.outside.end());
      std::vector<std::uint32_t>().swap(f.outside);
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t across = f.neighbors[i];
        if (facets_[across].gone) continue;
        if (sees(apex, facets_[across])) {
          facets_[across].gone = true;
          seen.push_back(across);
        }
      }
    }
    for (const std::uint32_t s : seen)
      for (int i = 0; i < 3; ++i)
        if (const std::uint32_t across = facets_[s].neighbors[i]; !facets_[across].gone)
          horizon.push_back({facets_[s].vertices[i], facets_[s].vertices[(i + 1) % 3], across});
  }

  std::span<const Vec3> points_;
  double extent_ = 0;
  std::vector<Facet> facets_;
};

}  // namespace

Mesh convex_hull(std::span<const Vec3> points) {
  if (points.size() < 4)
    throw std::invalid_argument("convex_hull: a solid needs at least 4 points, got " + std::to_string(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i]) || norm(points[i]) > 1e9)
      throw std::invalid_argument("convex_hull: point " + std::to_string(i) + " must be finite and within 1e9 m");
  return Hull(points).mesh();
}

}  // namespace iota
