// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_edges.h"

#include "contact/manifold.h"
#include "contact/segments.h"
#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace iota::contact {

namespace {

/// The first of all corners at the same place, of each: files have one for each color and normal.
std::vector<std::uint32_t> number_places(const std::vector<Vec3>& places) {
  std::vector<std::uint32_t> order(places.size()), number(places.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t k) { return std::tuple(places[k].x, places[k].y, places[k].z, k); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    number[order[i]] = i > 0 && places[order[i]] == places[order[i - 1]] ? number[order[i - 1]] : order[i];
  return number;
}

}  // namespace

bool MeshEdges::Edge::may_push(const Vec3& away) const {
  constexpr double along_face = 0.02, along_normal = 0.5;
  if (dot(away, into[0]) > along_face || dot(away, into[1]) > along_face) return false;
  return has_two() || std::abs(dot(away, normal)) > along_normal;
}

MeshEdges::MeshEdges(const Mesh& mesh, bool is_closed) {
  constexpr double flat = 1e-3;  // sine of the angle between two faces
  struct Side {
    std::uint32_t low, high;  // numbers of corners
    Vec3 normal, into;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  const std::vector<std::uint32_t> corner_of = number_places(mesh.vertices);
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle[k], to = triangle[(k + 1) % 3];
      const Vec3 &a = mesh.vertices[from], &b = mesh.vertices[to], &c = mesh.vertices[triangle[(k + 2) % 3]];
      const Vec3 normal = unit_or(cross(b - a, c - a), {});
      const auto [low, high] = std::minmax(corner_of[from], corner_of[to]);
      if (low != high && normal != Vec3{}) sides.push_back({low, high, normal, unit_or(cross(normal, b - a), {})});
    }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // of sides with the same ends, by these
  order.reserve(sides.size());
  for (const Side& side : sides)
    order.emplace_back(std::uint64_t{side.low} << 32 | side.high, static_cast<std::uint32_t>(order.size()));
  std::sort(order.begin(), order.end());
  for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
    end = begin + 1;
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    const Side& one = sides[order[begin].second];
    Edge edge{.a = mesh.vertices[one.low], .b = mesh.vertices[one.high], .into = {one.into}, .normal = one.normal};
    if (end - begin > 2) continue;
    if (end - begin == 2) {
      const Vec3& next = sides[order[begin + 1].second].into;
      if (norm(cross(one.into, next)) < flat && dot(one.into, next) < 0) continue;
      if (is_closed && dot(one.normal, next) > 0) continue;  // a hollow
      edge.into[1] = next;
    }
    edges_.push_back(edge);
  }
  std::vector<geometry::Bounds> boxes;
  boxes.reserve(edges_.size());
  for (const Edge& edge : edges_) boxes.push_back(geometry::around(edge.a, edge.b));
  tree_.build(boxes);
}

void add_touches_of_edges(const EdgedSolid& first, const EdgedSolid& second, std::uint32_t first_feature,
                          const Vec3& anchor, double within, std::vector<Touch>& found) {
  constexpr double parallel = 0.02;  // sine of the angle between two edges that do not cross
  constexpr double deepest = 0.1;    // of the smaller mesh
  const ConvexPart thin;
  TouchWriter writer(thin, thin, anchor, within, found);
  const auto size = [](const EdgedSolid& of) { return norm(of.solid.form->box.high - of.solid.form->box.low); };
  const auto to_anchor = [&](const EdgedSolid& of, const Vec3& p) {
    return of.solid.position - anchor + rotate(of.solid.turn, p);
  };
  const auto from_anchor = [&](const EdgedSolid& of, const Vec3& p) {
    return rotate(conjugate(of.solid.turn), p - (of.solid.position - anchor));
  };
  // Beneath an edge with a right angle a place is on the border: a little further inwards it is not.
  const auto is_beneath = [&](const EdgedSolid& of, const MeshEdges::Edge& edge, const Vec3& p, double depth) {
    return is_within(*of.solid.form, from_anchor(of, p) - 0.5 * depth * edge.outwards());
  };
  const double most = deepest * std::min(size(first), size(second)), reach = 0.5 * size(second) + within;
  const geometry::Bounds& box = second.solid.form->box;
  const Vec3 middle = from_anchor(first, to_anchor(second, 0.5 * (box.low + box.high)));
  first.edges.overlapping(geometry::grown({middle, middle}, reach), [&](std::uint32_t i, const MeshEdges::Edge& one) {
    const Vec3 a = to_anchor(first, one.a), b = to_anchor(first, one.b);
    const geometry::Bounds seen =
        geometry::grown(geometry::around(from_anchor(second, a), from_anchor(second, b)), std::max(within, most));
    second.edges.overlapping(seen, [&](std::uint32_t k, const MeshEdges::Edge& other) {
      const Vec3 c = to_anchor(second, other.a), d = to_anchor(second, other.b), across = cross(b - a, d - c);
      if (!(norm(across) > parallel * norm(b - a) * norm(d - c))) return;
      const NearestOfSegments nearest = nearest_of_segments(a, b, c, d);
      const Vec3 between = nearest.on_first - nearest.on_second;
      Vec3 normal = unit_or(across, {});
      if (dot(between, normal) < 0) normal = -normal;
      // At an end of one of them a corner touches, which is met by itself.
      constexpr double beside_normal = 1e-6;
      if (norm(between - dot(between, normal) * normal) > beside_normal * (norm(between) + norm(b - a))) return;
      const auto may_push = [&](const Vec3& away) {
        return other.may_push(rotate(conjugate(second.solid.turn), away)) &&
               one.may_push(rotate(conjugate(first.solid.turn), -away));
      };
      if (!may_push(normal)) {
        const double depth = norm(between);
        const bool is_in = depth <= most && may_push(-normal) && is_beneath(second, other, nearest.on_first, depth) &&
                           is_beneath(first, one, nearest.on_second, depth);
        if (!is_in) return;
        normal = -normal;
      }
      writer.add_edges(nearest.on_first, nearest.on_second, normal, {first.solid.number, first_feature + 3 * i},
                       {second.solid.number, first_feature + 3 * k});
    });
  });
}

}  // namespace iota::contact
