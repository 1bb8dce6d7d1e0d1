// SPDX-License-Identifier: Apache-2.0
#include "contact/round_pairs.h"

#include "contact/closest.h"
#include "contact/round_axis.h"
#include "contact/segments.h"

#include <algorithm>
#include <cmath>

namespace iota::contact {

namespace {

constexpr double parallel_segments = 1e-6;        ///< sine: there is no common normal
constexpr double nearly_parallel_segments = 0.3;  ///< sine: the ends may touch too
constexpr double leaning = 1e-3;     ///< sine: an edge that lies on something rather than one of its corners
constexpr double flush_end = 1e-5;   ///< of the size: what is so far beyond an end is still beside it
constexpr double end_share = 1e-9;   ///< share of a segment
constexpr double same_end = 1e-3;    ///< of the size
constexpr double least_apart = 0.5;  ///< of two lines, of their radii: deeper their way from each other tells nothing

struct Segment {
  const ConvexPart& part;
  std::uint32_t edge, from, to;

  const Vec3& a() const { return part.corners[from]; }
  Vec3 along() const { return part.corners[to] - part.corners[from]; }
};

double share_of(const Segment& segment, const Vec3& place) {
  const Vec3 along = segment.along();
  const double squared = dot(along, along);
  return squared > 0 ? dot(place - segment.a(), along) / squared : 0;
}

Vec3 unit_of(const Vec3& v) { return (1 / norm(v)) * v; }

/// How far beyond its ends a share of a segment counts as on it.
double share_of_flush_end(const Segment& segment) {
  const double length = norm(segment.along());
  return length > 0 ? std::min(0.5, flush_end * segment.part.size / length) : 0;
}

bool is_end(double share) { return !(share > end_share && share < 1 - end_share); }

/// An end of a segment and the nearest point of another one, at this share.
void add_end(TouchWriter& writer, bool is_of_first, const ConvexPart& part, std::uint32_t corner, const Segment& other,
             double share) {
  const double flush = share_of_flush_end(other);
  const bool is_beyond = share < -flush || share > 1 + flush;
  const Vec3 along = other.along(), on_other = other.a() + (is_beyond ? std::clamp(share, 0.0, 1.0) : share) * along;
  const FeatureName name = part.corner_name(corner);
  const FeatureName other_name =
      is_beyond ? other.part.corner_name(share < 0 ? other.from : other.to) : other.part.edge_name(other.edge);
  const Vec3 axis = is_beyond || !(dot(along, along) > 0) ? Vec3{} : unit_of(along);
  if (is_of_first)
    writer.add_round(part.corners[corner], on_other, axis, name, other_name);
  else
    writer.add_round(on_other, part.corners[corner], axis, other_name, name);
}

/// Ends of two segments, each with its share of the other one.
struct EndList {
  struct End {
    bool is_of_first;
    std::uint32_t corner;
    double share;
    Vec3 place;
  };
  const Segment &a, &b;
  const Vec3 along;
  const double tolerance;
  End ends[5];
  std::size_t count = 0;

  EndList(const Segment& first, const Segment& second)
      : a(first),
        b(second),
        along(unit_of(first.along())),
        tolerance(same_end * std::min(first.part.size, second.part.size)) {}
  End* find(const Vec3& place, double within) {
    End* const end =
        std::find_if(ends, ends + count, [&](const End& e) { return std::abs(dot(along, e.place - place)) <= within; });
    return end == ends + count ? nullptr : end;
  }
  End make(bool is_of_first, std::uint32_t corner) const {
    const Vec3& place = (is_of_first ? a : b).part.corners[corner];
    return {is_of_first, corner, share_of(is_of_first ? b : a, place), place};
  }
  /// An end that is beside the other segment. Ends that are side by side count once.
  void add_beside(bool is_of_first, std::uint32_t corner) {
    const End end = make(is_of_first, corner);
    const double flush = share_of_flush_end(is_of_first ? b : a);
    if (end.share >= -flush && end.share <= 1 + flush && !find(end.place, tolerance)) ends[count++] = end;
  }
  /// The end that is nearest to the other segment.
  void add_nearest(bool is_of_first, std::uint32_t corner) {
    const End end = make(is_of_first, corner);
    if (find(end.place, tolerance * flush_end / same_end)) return;
    End* const known = find(end.place, tolerance);
    (known ? *known : ends[count++]) = end;
  }
  /// The touches in the order of the list.
  void write(TouchWriter& writer) const {
    for (std::size_t k = 0; k < count; ++k)
      add_end(writer, ends[k].is_of_first, (ends[k].is_of_first ? a : b).part, ends[k].corner,
              ends[k].is_of_first ? b : a, ends[k].share);
  }
};

/// The nearest points, and of nearly parallel segments also the ends of the length that they have side by side.
void add_touches(TouchWriter& writer, const Segment& a, const Segment& b) {
  const Vec3 u = a.along(), v = b.along(), normal = cross(u, v);
  const NearestOfSegments nearest = nearest_of_segments(a.a(), a.a() + u, b.a(), b.a() + v);
  const double sine = norm(normal) / (norm(u) * norm(v));
  const bool is_parallel = !(sine > parallel_segments);
  EndList list(a, b);
  if (sine < nearly_parallel_segments || is_parallel) {
    for (const std::uint32_t corner : {a.from, a.to}) list.add_beside(true, corner);
    for (const std::uint32_t corner : {b.from, b.to}) list.add_beside(false, corner);
  }
  if (is_end(nearest.of_first)) {
    list.add_nearest(true, nearest.of_first < 0.5 ? a.from : a.to);
  } else if (is_end(nearest.of_second)) {
    list.add_nearest(false, nearest.of_second < 0.5 ? b.from : b.to);
  } else if (!is_parallel) {
    const double side = dot(normal, nearest.on_first - nearest.on_second);
    const bool is_clear = std::abs(side) > 1e-12 * norm(normal) * std::min(a.part.size, b.part.size);
    const double sign = (is_clear ? side : dot(normal, a.part.middle - b.part.middle)) < 0 ? -1 : 1;
    const Vec3 out = (sign / norm(normal)) * normal;
    const FeatureName of_first = a.part.edge_name(a.edge), of_second = b.part.edge_name(b.edge);
    // Their normal turns with both: a rope of rods on a post slid off, as its rods rocked on planes that stayed.
    if (dot(out, nearest.on_first - nearest.on_second) > least_apart * (a.part.radius + b.part.radius))
      writer.add_wires(nearest.on_first, nearest.on_second, (1 / norm(u)) * u, {}, (1 / norm(v)) * v, {}, of_first,
                       of_second);
    else
      writer.add_edges(nearest.on_first, nearest.on_second, out, of_first, of_second);
  }
  list.write(writer);
}

/// The edge that is farthest in a direction, and nearly at right angles to it; otherwise a corner is, one of these.
std::uint32_t edge_along(const ConvexPart& part, const Vec3& direction, const std::array<std::uint32_t, 4>& corners,
                         std::uint32_t count, std::uint32_t& corner) {
  for (std::uint32_t k = 0; k < count; ++k)
    if (dot(direction, part.corners[corners[k]]) > dot(direction, part.corners[corner])) corner = corners[k];
  std::uint32_t best = Polytope::none;
  double least = leaning;
  for (std::uint32_t e = 0; e < part.core->edges.size(); ++e) {
    const Polytope::Edge& edge = part.core->edges[e];
    if (edge.from != corner && edge.to != corner) continue;
    const Vec3 along = part.corners[edge.to] - part.corners[edge.from];
    const double lean = std::abs(dot(along, direction)), length = norm(along);
    if (lean < least * length) best = e, least = lean / length;
  }
  return best;
}

}  // namespace

void add_touches_of_segments(TouchWriter& writer) {
  const ConvexPart &first = writer.first(), &second = writer.second();
  const Segment a{first, 0, 0, 1}, b{second, 0, 0, 1};
  if (first.is_point() && second.is_point())
    writer.add_round(first.corners[0], second.corners[0], {}, first.corner_name(0), second.corner_name(0));
  else if (first.is_point())
    add_end(writer, true, first, 0, b, share_of(b, first.corners[0]));
  else if (second.is_point())
    add_end(writer, false, second, 0, a, share_of(a, second.corners[0]));
  else
    add_touches(writer, a, b);
}

bool add_touches_of_corners(TouchWriter& writer, double apart) {
  const ConvexPart &first = writer.first(), &second = writer.second();
  const auto support_of = [](const ConvexPart& part) {
    return [&part](const Vec3& direction) {
      const std::uint32_t corner = part.support(direction);
      return Support{part.corners[corner], corner};
    };
  };
  const auto of_first = support_of(first), of_second = support_of(second);
  const Closest found = closest(of_first, of_second, first.middle - second.middle);
  // By a plane between them, as the distance is right only to round-off.
  const double along = found.distance > 0 ? apart_along(first, second, found.normal) : 0;
  if (!(along > apart * (1 + 1e-9) + 1e-12 * std::min(first.size, second.size))) return false;
  std::uint32_t corner = found.first[0], other_corner = found.second[0];
  const std::uint32_t edge = edge_along(first, -found.normal, found.first, found.count, corner),
                      other_edge = edge_along(second, found.normal, found.second, found.count, other_corner);
  const auto segment = [](const ConvexPart& part, std::uint32_t e) {
    return Segment{part, e, part.core->edges[e].from, part.core->edges[e].to};
  };
  if (edge == Polytope::none && other_edge == Polytope::none) {
    writer.add_round(first.corners[corner], second.corners[other_corner], {}, first.corner_name(corner),
                     second.corner_name(other_corner));
  } else if (edge == Polytope::none) {
    const Segment other = segment(second, other_edge);
    add_end(writer, true, first, corner, other, share_of(other, first.corners[corner]));
  } else if (other_edge == Polytope::none) {
    const Segment own = segment(first, edge);
    add_end(writer, false, second, other_corner, own, share_of(own, second.corners[other_corner]));
  } else {
    add_touches(writer, segment(first, edge), segment(second, other_edge));
  }
  return true;
}

}  // namespace iota::contact
