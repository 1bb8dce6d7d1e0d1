// SPDX-License-Identifier: Apache-2.0
// Gottschalk, Lin, Manocha, OBBTree, 1996, for boxes; Gregorius, The separating axis test between convex polyhedra, 2013:
// only edges whose arcs on the sphere of normals cross make a face of the difference of the two.
#include "contact/axis.h"

#include "contact/round_axis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace iota::contact {

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double parallel_edges = 1e-6;  ///< sine, of edges without a common normal
constexpr double flush_sine = 5e-3;      ///< sine, of normals that count as the same
constexpr double preference_of_size = 1e-3, preference_of_distance = 1e-2,
                 slight_preference = 1e-6;              ///< preferences: see is_better
constexpr std::size_t most_edge_pairs = 4096;           ///< more are looked at only near a direction
constexpr double near_hint = 0.8, near_support = 0.02;  ///< cosine; of the size
constexpr double settled_overlap = 1e-4;                ///< of the size: an overlap of what touches

/// The best of some axes.
struct Best {
  Axis axis{.apart = -unbounded};
  double score = -unbounded;
  bool is_open = false;  ///< the parts do not overlap along it
};

double margin_of(const Axis& axis, double size) {
  return preference_of_size * size + preference_of_distance * std::abs(axis.apart);
}

class AxisSearch {
 public:
  AxisSearch(const ConvexPart& first, const ConvexPart& second, const Vec3& way, double limit)
      : first_(first), second_(second), way_(way), limit_(limit), size_(std::min(first.size, second.size)) {}

  std::optional<Axis> run() {
    if (first_.core->edges.size() * second_.core->edges.size() > most_edge_pairs) {
      const std::optional<RoundAxis> axis = find_round_axis(first_, second_, guess_round_axis(first_, second_), limit_);
      if (!axis) return {};
      hint_ = axis->normal;
    }
    if (!look_at_faces(second_, first_, of_second_) || !look_at_faces(first_, second_, of_first_)) return {};
    if (first_.is_box && second_.is_box ? !look_at_edges_of_boxes() : !look_at_edges()) return {};
    Best* best = &of_second_;
    if (is_better(of_first_, *best)) best = &of_first_;
    if (is_better(edges_, *best)) best = &edges_;
    best->axis.most_apart = most_apart_;
    if (edges_.score > -unbounded)
      best->axis.edges = {edges_.axis.first, edges_.axis.second, edges_.axis.normal, edges_.axis.apart};
    best->axis.is_farthest = best->axis.apart >= most_apart_ - 2 * margin_of(best->axis, size_);
    return best->axis;
  }

 private:
  /// False: they are too far apart.
  bool take(Axis::Kind kind, std::uint32_t first, std::uint32_t second, const Vec3& normal, double apart, Best& best) {
    if (apart > limit_) return false;
    most_apart_ = std::max(most_apart_, apart);
    const bool is_open = apart >= -settled_overlap * size_;
    const double score = is_open ? apart + std::min(0.0, dot(normal, way_)) : apart;
    if (is_open < best.is_open || (is_open == best.is_open && !(score > best.score + 1e-12 * size_))) return true;
    best = {{kind, first, second, normal, apart}, score, is_open};
    return true;
  }

  bool look_at_faces(const ConvexPart& owner, const ConvexPart& other, Best& best) {
    const bool is_second = &owner == &second_;
    for (std::uint32_t f = 0; f < owner.normals.size(); ++f) {
      const Vec3& normal = owner.normals[f];
      if (hint_ && (is_second ? 1 : -1) * dot(*hint_, normal) < near_hint) continue;
      const Vec3& origin = owner.corners[owner.core->sides[owner.core->faces[f].begin].corner];
      double least = unbounded;
      for (const Vec3& corner : other.corners) least = std::min(least, dot(normal, corner - origin));
      if (!take(is_second ? Axis::Kind::face_of_second : Axis::Kind::face_of_first, f, f, is_second ? normal : -normal,
                least, best))
        return false;
    }
    return true;
  }

  bool look_at_edges_of_boxes() {
    const Vec3 between = first_.middle - second_.middle;
    const double a_half[] = {first_.half.x, first_.half.y, first_.half.z},
                 b_half[] = {second_.half.x, second_.half.y, second_.half.z};
    for (std::uint32_t i = 0; i < 3; ++i)
      for (std::uint32_t k = 0; k < 3; ++k) {
        Vec3 normal = cross(first_.axes[i], second_.axes[k]);
        const double squared = dot(normal, normal);
        if (!(squared > parallel_edges * parallel_edges)) continue;
        normal *= (dot(normal, between) < 0 ? -1 : 1) / std::sqrt(squared);
        double apart = dot(normal, between);
        std::uint32_t of_first = 4 * i, of_second = 4 * k;
        for (std::uint32_t other = 1; other < 3; ++other) {
          const std::uint32_t a = (i + other) % 3, b = (k + other) % 3;
          const double a_along = dot(normal, first_.axes[a]), b_along = dot(normal, second_.axes[b]);
          apart -= a_half[a] * std::abs(a_along) + b_half[b] * std::abs(b_along);
          if (a_along < 0) of_first += 3 - other;
          if (b_along > 0) of_second += 3 - other;
        }
        if (!take(Axis::Kind::edges, of_first, of_second, normal, apart, edges_)) return false;
      }
    return true;
  }

  bool look_at_edges() {
    const auto &a = *first_.core, &b = *second_.core;
    thread_local std::vector<std::uint32_t> of_first, of_second;
    list_edges(first_, -1, of_first), list_edges(second_, 1, of_second);
    for (const std::uint32_t i : of_first) {
      const Vec3 along = first_.corners[a.edges[i].to] - first_.corners[a.edges[i].from];
      for (const std::uint32_t k : of_second) {
        const Vec3 other = second_.corners[b.edges[k].to] - second_.corners[b.edges[k].from];
        if (!do_arcs_cross(a.edges[i], along, b.edges[k], other)) continue;
        Vec3 normal = cross(along, other);
        const double squared = dot(normal, normal);
        if (!(squared > parallel_edges * parallel_edges * dot(along, along) * dot(other, other))) continue;
        normal *= 1 / std::sqrt(squared);
        // Along an outward normal of the second edge, against one of the first.
        const bool is_second = !b.faces.empty();
        const auto& edge = is_second ? b.edges[k] : a.edges[i];
        const ConvexPart& owner = is_second ? second_ : first_;
        const double outward = dot(normal, owner.normals[edge.left] + owner.normals[edge.right]);
        if (is_second ? outward < 0 : outward > 0) normal *= -1;
        const double apart = dot(normal, first_.corners[a.edges[i].from] - second_.corners[b.edges[k].from]);
        if (!take(Axis::Kind::edges, i, k, normal, apart, edges_)) return false;
      }
    }
    return true;
  }

  /// The edges that may be nearest to the other part: with a hint, those that are nearly the farthest along it.
  void list_edges(const ConvexPart& part, double sign, std::vector<std::uint32_t>& edges) const {
    edges.clear();
    const double least =
        hint_ ? sign * dot(*hint_, part.corners[part.support(sign * *hint_)]) - near_support * size_ : 0;
    const auto is_far = [&](std::uint32_t corner) { return sign * dot(*hint_, part.corners[corner]) >= least; };
    for (std::uint32_t e = 0; e < part.core->edges.size(); ++e)
      if (!hint_ || (is_far(part.core->edges[e].from) && is_far(part.core->edges[e].to))) edges.push_back(e);
  }

  /// The normals of an edge are an arc between those of its faces; of a segment, all around it.
  bool do_arcs_cross(const Polytope::Edge& a, const Vec3& along_a, const Polytope::Edge& b, const Vec3& along_b) const {
    if ((!first_.core->faces.empty() && a.right == Polytope::none) ||
        (!second_.core->faces.empty() && b.right == Polytope::none))
      return false;
    double of_b[2] = {}, of_a[2] = {};
    if (!second_.core->faces.empty()) {
      of_b[0] = -dot(second_.normals[b.left], along_a), of_b[1] = -dot(second_.normals[b.right], along_a);
      if (of_b[0] * of_b[1] >= 0) return false;
    }
    if (!first_.core->faces.empty()) {
      of_a[0] = dot(first_.normals[a.left], along_b), of_a[1] = dot(first_.normals[a.right], along_b);
      if (of_a[0] * of_a[1] >= 0) return false;
    }
    if (first_.core->faces.empty() || second_.core->faces.empty()) return true;
    // Both on one hemisphere: the arcs meet, and not one the other's antipode.
    const Vec3 n = cross(along_a, along_b);
    const double at_a = dot(n, first_.normals[a.left] + first_.normals[a.right]),
                 at_b = -dot(n, second_.normals[b.left] + second_.normals[b.right]);
    return at_a * at_b > 0;
  }

  /// Whether a less preferred one is clearly better: clearly enough that bodies that lie flush_sine do not change their touches with the noise.
  bool is_better(const Best& one, const Best& preferred) const {
    if (one.score == -unbounded || preferred.score == -unbounded) return preferred.score < one.score;
    if (norm(cross(one.axis.normal, preferred.axis.normal)) < flush_sine &&
        dot(one.axis.normal, preferred.axis.normal) > 0)
      return one.axis.apart > preferred.axis.apart + margin_of(preferred.axis, size_);
    if (one.is_open != preferred.is_open) return one.is_open;
    return one.score > preferred.score + slight_preference * size_;
  }

  const ConvexPart &first_, &second_;
  const Vec3 way_;
  const double limit_, size_;
  std::optional<Vec3> hint_;  ///< of polytopes with many edges: about the direction
  double most_apart_ = -unbounded;
  Best of_second_, of_first_, edges_;
};

}  // namespace

std::optional<Axis> find_axis(const ConvexPart& first, const ConvexPart& second, const Vec3& way, double limit) {
  return AxisSearch(first, second, way, limit).run();
}

}  // namespace iota::contact
