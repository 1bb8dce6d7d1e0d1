// SPDX-License-Identifier: Apache-2.0
#include "contact/manifold.h"

#include "contact/segments.h"

#include <algorithm>
#include <cmath>

namespace iota::contact {

namespace {

constexpr double flush_share = 1e-6;  ///< of the size: a corner that is so far beyond a side is still over the face
constexpr double same_share = 1e-6;   ///< of the size: points so near to each other are one
constexpr std::size_t spanning = 4;   ///< points that are chosen by area
constexpr std::uint32_t side_bit = 1u << 31;  ///< a number of a side, not of an edge

/// The outward normal of a side of a face; zero where it has no length. A face of a rounded box may be a line or a point.
Vec3 outward_of_side(const ConvexPart& owner, std::uint32_t face, std::uint32_t side, double tolerance) {
  const Polytope::Face& loop = owner.core->faces[face];
  const auto corner = [&](std::uint32_t s) { return owner.corners[owner.core->sides[s].corner]; };
  const Vec3 outward = cross(corner(side + 1 < loop.end ? side + 1 : loop.begin) - corner(side), owner.normals[face]);
  const double length = norm(outward);
  if (length > tolerance) return (1 / length) * outward;
  if (!owner.is_box) return {};
  // The sides of a face at +-1 along an axis follow the next two axes: see cube_polytope.
  const std::uint32_t axis = face / 2, at = side - loop.begin;
  const bool is_along_next = (at % 2 == 0) == (face % 2 == 1);
  const std::uint32_t across = is_along_next ? (axis + 2) % 3 : (axis + 1) % 3;
  const bool is_high = (owner.core->sides[side].corner >> across & 1) != 0;
  return is_high ? owner.axes[across] : -owner.axes[across];
}

}  // namespace

void TouchWriter::add_face(bool is_turned, const Vec3& center, double radius, const Vec3& normal, double apart,
                           const FeatureName& of_point, const FeatureName& of_plane, const std::optional<Rim>& rim) {
  const ConvexPart& plane = is_turned ? first_ : second_;
  const double gap = apart - radius - plane.radius;
  if (!(gap <= within_)) return;
  const FeatureName &first = is_turned ? of_plane : of_point, &second = is_turned ? of_point : of_plane;
  found_.push_back({.part = first.part,
                    .feature = first.feature,
                    .other_part = second.part,
                    .other_feature = second.feature,
                    .is_turned = is_turned,
                    .form = TouchForm::face,
                    .center = anchor_ + center,
                    .place = anchor_ + center - radius * normal,
                    .origin = anchor_ + center - (apart - plane.radius) * normal,
                    .normal = normal,
                    .axis = {},
                    .radius = radius,
                    .gap = gap,
                    .rim = rim});
}

void TouchWriter::add_edges(const Vec3& on_first, const Vec3& on_second, const Vec3& normal,
                            const FeatureName& of_first, const FeatureName& of_second) {
  const double radius = first_.radius + second_.radius, gap = dot(normal, on_first - on_second) - radius;
  if (!(gap <= within_)) return;
  found_.push_back({.part = of_first.part,
                    .feature = of_first.feature,
                    .other_part = of_second.part,
                    .other_feature = of_second.feature,
                    .is_turned = false,
                    .form = TouchForm::edges,
                    .center = anchor_ + on_first,
                    .place = anchor_ + on_first - first_.radius * normal,
                    .origin = anchor_ + on_second,
                    .normal = normal,
                    .axis = {},
                    .radius = radius,
                    .gap = gap});
}

void TouchWriter::add_round(const Vec3& on_first, const Vec3& on_second, const Vec3& axis, const FeatureName& of_first,
                            const FeatureName& of_second) {
  const Vec3 between = on_first - on_second, away = between - dot(axis, between) * axis;
  const double apart = norm(away);
  if (!(apart > 0)) {  // any direction is as good
    const Vec3 along = dot(axis, axis) > 0 ? axis : Vec3{1, 0, 0};
    const Vec3 normal = cross(along, std::abs(along.y) < 0.6 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
    return add_edges(on_first, on_second, (1 / norm(normal)) * normal, of_first, of_second);
  }
  const std::size_t before = found_.size();
  add_edges(on_first, on_second, (1 / apart) * away, of_first, of_second);
  if (found_.size() > before) found_.back().form = TouchForm::round, found_.back().axis = axis;
}

// Moved aside by w, the square of the distance r of two curves p + u s + b u^2/2 and q + v t + c v^2/2 is that of their nearest
// points: r^2 + min |w + u s - v t|^2 + r (b . n u^2 - c . n v^2), n from the second to the first. It is r^2 + w . M w with
// M = 1 - J (J^T J + K)^-1 J^T, J = [s, -t]: zero of straight ones, negative of those that bend around each other.
void TouchWriter::add_wires(const Vec3& on_first, const Vec3& on_second, const Vec3& along_first,
                            const Vec3& bend_of_first, const Vec3& along_second, const Vec3& bend_of_second,
                            const FeatureName& of_first, const FeatureName& of_second) {
  const Vec3 between = on_first - on_second;
  const double apart = norm(between);
  if (!(apart > 0)) return;
  const Vec3 normal = (1 / apart) * between, along = along_first - dot(along_first, normal) * normal;
  const std::size_t before = found_.size();
  add_edges(on_first, on_second, normal, of_first, of_second);
  if (found_.size() == before || !(dot(along, along) > 0)) return;
  Touch& touch = found_.back();
  touch.form = TouchForm::wires, touch.axis = (1 / norm(along)) * along;
  const Vec3 side = cross(normal, touch.axis);
  constexpr double askew = 0.2, least = 0.1,
                   most_bent = 3;  // of J^T J + K, whose determinant is 1 for straight wires at right angles; of M
  const double x = dot(along_second, touch.axis), y = dot(along_second, side);
  const double uu = 1 + touch.radius * dot(bend_of_first, normal), uv = -x,
               vv = x * x + y * y - touch.radius * dot(bend_of_second, normal), determinant = uu * vv - uv * uv;
  if (!(uu > 0) || !(determinant > least * y * y)) return;
  const auto m = [&](double j_u, double j_v, double k_u, double k_v) {  // of two rows of J
    return (j_u * (vv * k_u - uv * k_v) + j_v * (uu * k_v - uv * k_u)) / determinant;
  };
  const double aa = 1 - m(1, -x, 1, -x), ab = -m(1, -x, 0, -y), bb = 1 - m(0, -y, 0, -y);
  double of_axis = aa, of_side = bb;
  // Each axis turns with its wire, unless they are far from right angles.
  if (std::abs(x) > askew) {
    const double turn = 0.5 * std::atan2(2 * ab, aa - bb), c = std::cos(turn), s = std::sin(turn);
    of_axis = c * c * aa + 2 * c * s * ab + s * s * bb, of_side = aa + bb - of_axis;
    touch.axis = c * touch.axis + s * side;
    if (std::abs(s) > c) touch.axis = cross(touch.axis, normal), std::swap(of_axis, of_side);
  }
  touch.bends[0] = 1 - std::clamp(of_axis, -most_bent, 1.0), touch.bends[1] = 1 - std::clamp(of_side, -most_bent, 1.0);
}

void Clipper::add_touches(const Axis& axis, TouchWriter& writer, std::size_t most) {
  if (axis.kind == Axis::Kind::edges)
    add_edge_touch(axis.edges, writer);
  else
    add_face_touches(axis, writer, most);
}

void Clipper::add_edge_touch(const Axis::Edges& edges, TouchWriter& writer) {
  const ConvexPart &first = writer.first(), &second = writer.second();
  const Polytope::Edge &a = first.core->edges[edges.first], &b = second.core->edges[edges.second];
  const NearestOfSegments nearest =
      nearest_of_segments(first.corners[a.from], first.corners[a.to], second.corners[b.from], second.corners[b.to]);
  writer.add_edges(nearest.on_first, nearest.on_second, edges.normal, first.edge_name(edges.first),
                   second.edge_name(edges.second));
}

void Clipper::add_face_touches(const Axis& axis, TouchWriter& writer, std::size_t most) {
  const bool is_turned = axis.kind == Axis::Kind::face_of_first;
  const ConvexPart &owner = is_turned ? writer.first() : writer.second(),
                   &other = is_turned ? writer.second() : writer.first();
  const std::uint32_t face = is_turned ? axis.first : axis.second;
  const Vec3& normal = owner.normals[face];
  const Vec3& origin = owner.corners[owner.core->sides[owner.core->faces[face].begin].corner];
  const double size = std::min(owner.size, other.size), radius = owner.radius + other.radius;
  start_with_nearest(owner, face, other);
  clip(owner, face, other);
  points_.clear();
  double least = std::numeric_limits<double>::infinity();
  for (const Corner& corner : polygon_) {
    const double apart = dot(normal, corner.place - origin);
    if (!(apart - radius <= writer.within())) continue;
    const bool is_known = std::ranges::any_of(
        points_, [&](const FacePoint& point) { return norm(point.place - corner.place) <= same_share * size; });
    if (!is_known)
      points_.push_back({corner.place, apart, corner.of_point, corner.of_plane}), least = std::min(least, apart);
  }
  // The least gap is not larger than the distance: what is nearest may be beyond the face, or not on the clipped one.
  constexpr double nearly = 2e-5;
  // A whole rim: every other point.
  const bool is_rim =
      !other.is_polytope() && points_.size() == corners_of_rim && polygon_.size() == corners_of_rim && !is_clipped_;
  if (is_rim)
    for (std::size_t k = 1; k < points_.size(); ++k) points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(k));
  if (axis.is_farthest &&
      (polygon_.empty() || least > axis.most_apart + nearly * std::abs(axis.most_apart) + same_share * size)) {
    if (axis.edges.apart > axis.apart) {
      add_edge_touch(axis.edges, writer);
      --most;
    } else if (polygon_.empty() || axis.apart > 0) {
      const std::uint32_t corner = other.support(-normal);
      points_.push_back({other.corners[corner], axis.apart, other.corner_name(corner), owner.face_name(face)});
    }
  }
  keep(most, size);
  const std::size_t whole = points_.size();
  std::optional<Rim> rim;
  if (is_rim && whole == corners_of_rim / 2) {
    Vec3 middle;
    for (const FacePoint& point : points_) middle += (1.0 / static_cast<double>(whole)) * point.place;
    rim = Rim{writer.anchor() + middle, other.half.y * other.axes[1], other.half.y * other.axes[2],
              dot(middle - other.middle, other.axes[0]) > 0 ? 1u : 0u};
  }
  for (const FacePoint& point : points_)
    writer.add_face(is_turned, point.place, other.radius, normal, point.apart, point.of_point, point.of_plane, rim);
}

bool Clipper::add_rod(const Axis& axis, const End& a, const End& b, const FeatureName& between, TouchWriter& writer) {
  const bool is_turned = axis.kind == Axis::Kind::face_of_first;
  const ConvexPart& owner = is_turned ? writer.first() : writer.second();
  const std::uint32_t face = is_turned ? axis.first : axis.second;
  const Polytope::Face& sides = owner.core->faces[face];
  const Vec3 &normal = owner.normals[face], &origin = owner.corners[owner.core->sides[sides.begin].corner];
  const double tolerance = flush_share * std::min(writer.first().size, writer.second().size);
  double from = 0, to = 1;
  std::uint32_t at_from = Polytope::none, at_to = Polytope::none;  // sides
  for (std::uint32_t s = sides.begin; s < sides.end; ++s) {
    const Vec3& corner = owner.corners[owner.core->sides[s].corner];
    const Vec3 outward = outward_of_side(owner, face, s, tolerance);
    const double here = dot(outward, a.center - corner), there = dot(outward, b.center - corner);
    if (here > tolerance && there > tolerance) return false;
    if (here <= tolerance && there <= tolerance) continue;
    const double share = std::clamp(here / (here - there), 0.0, 1.0);
    if (here > there && share > from) from = share, at_from = s;
    if (here < there && share < to) to = share, at_to = s;
  }
  if (from > to) return false;
  const auto add = [&](double share, std::uint32_t side, const FeatureName& end) {
    const Vec3 center = a.center + share * (b.center - a.center);
    writer.add_face(is_turned, center, a.radius + share * (b.radius - a.radius), normal, dot(normal, center - origin),
                    side == Polytope::none ? end : between,
                    side == Polytope::none ? owner.face_name(face) : owner.side_name(side));
  };
  add(from, at_from, a.name);
  if (norm(b.center - a.center) * (to - from) > same_share * owner.size) add(to, at_to, b.name);
  return true;
}

/// The corner, edge or face of the other part that is nearest to the plane of a face.
void Clipper::start_with_nearest(const ConvexPart& owner, std::uint32_t face, const ConvexPart& other) {
  polygon_.clear(), is_clipped_ = false;
  const FeatureName plane = owner.face_name(face);
  const auto add = [&](std::uint32_t corner, std::uint32_t edge) {
    polygon_.push_back({other.corners[corner], other.corner_name(corner), plane, edge});
  };
  incident_ = Polytope::none;
  if (other.normals.empty()) {
    for (std::uint32_t k = 0; k < other.corners.size(); ++k) add(k, 0);
    return;
  }
  // One that has the nearest corner.
  const Vec3& normal = owner.normals[face];
  double nearest = std::numeric_limits<double>::infinity(), least = 2;
  for (const Vec3& corner : other.corners) nearest = std::min(nearest, dot(normal, corner));
  nearest += same_share * std::min(owner.size, other.size);
  for (std::uint32_t f = 0; f < other.normals.size(); ++f) {
    const double along = dot(other.normals[f], normal);
    if (!(along < least - 1e-9)) continue;
    const Polytope::Face& sides = other.core->faces[f];
    bool has_nearest = other.is_box;
    for (std::uint32_t k = sides.begin; k < sides.end && !has_nearest; ++k)
      has_nearest = dot(normal, other.corners[other.core->sides[k].corner]) <= nearest;
    if (has_nearest) least = along, incident_ = f;
  }
  const Polytope::Face& incident = other.core->faces[incident_];
  for (std::uint32_t s = incident.begin; s < incident.end; ++s)
    add(other.core->sides[s].corner, other.core->sides[s].edge);
}

void Clipper::clip(const ConvexPart& owner, std::uint32_t face, const ConvexPart& other) {
  const Polytope::Face& sides = owner.core->faces[face];
  const double tolerance = flush_share * std::min(owner.size, other.size);
  for (std::uint32_t s = sides.begin; s < sides.end && !polygon_.empty(); ++s) {
    clip_by(owner, face, s, other, outward_of_side(owner, face, s, tolerance), tolerance);
  }
}

void Clipper::clip_by(const ConvexPart& owner, std::uint32_t face, std::uint32_t side, const ConvexPart& other,
                      const Vec3& outward, double tolerance) {
  const Vec3& origin = owner.corners[owner.core->sides[side].corner];
  const auto beyond = [&](const Corner& corner) { return dot(outward, corner.place - origin); };
  bool is_any_outside = false;
  for (const Corner& corner : polygon_) is_any_outside = is_any_outside || beyond(corner) > tolerance;
  if (!is_any_outside) return;
  is_clipped_ = true;
  clipped_.clear();
  const bool is_open = polygon_.size() <= 2;  // an edge or a corner
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    const Corner& now = polygon_[k];
    const double here = beyond(now);
    const bool is_inside = here <= tolerance;
    if (is_inside) clipped_.push_back(now);
    if (is_open && k + 1 == polygon_.size()) break;
    const Corner& next = polygon_[k + 1 < polygon_.size() ? k + 1 : 0];
    const double there = beyond(next);
    if (is_inside == (there <= tolerance)) continue;
    const double share = std::clamp(here / (here - there), 0.0, 1.0);
    Corner crossing{now.place + share * (next.place - now.place), {}, {}, is_inside ? side_bit | side : now.edge};
    if (now.edge & side_bit) {  // two sides of the face: its corner, over a face of the other part
      const Polytope::Face& loop = owner.core->faces[face];
      const std::uint32_t before = now.edge & ~side_bit;
      const bool is_next = side == before + 1 || (before + 1 == loop.end && side == loop.begin);
      crossing.of_point = other.beneath_name(incident_);
      crossing.of_plane = owner.corner_name(owner.core->sides[is_next ? side : before].corner);
    } else {
      crossing.of_point = other.edge_name(now.edge);
      crossing.of_plane = owner.side_name(side);
    }
    clipped_.push_back(crossing);
  }
  std::swap(polygon_, clipped_);
}

/// The nearest one, that which is farthest from it, and on each side of the line between them that which is farthest from the line. Of
/// those that are equally good the first one stays.
void Clipper::keep(std::size_t most_points, double size) {
  constexpr double equal = 1e-3;
  if (points_.size() <= most_points) return;
  const auto pick = [&](std::size_t begin, auto worth, double tolerance) {
    std::size_t best = begin;
    for (std::size_t k = begin + 1; k < points_.size(); ++k)
      if (worth(points_[k]) > worth(points_[best]) + tolerance) best = k;
    // The others keep their order.
    std::rotate(points_.begin() + static_cast<std::ptrdiff_t>(begin),
                points_.begin() + static_cast<std::ptrdiff_t>(best),
                points_.begin() + static_cast<std::ptrdiff_t>(best) + 1);
  };
  pick(0, [](const FacePoint& p) { return -p.apart; }, same_share * size);
  const Vec3 a = points_[0].place;
  pick(1, [&](const FacePoint& p) { return norm(p.place - a); }, equal * size);
  const Vec3 along = points_[1].place - a;
  Vec3 normal;
  double most = 0;
  for (std::size_t k = 2; k < points_.size(); ++k) {
    const Vec3 area = cross(along, points_[k].place - a);
    if (norm(area) > most * (1 + equal)) normal = area, most = norm(area);
  }
  const auto area = [&](const FacePoint& p) { return most > 0 ? dot(normal, cross(along, p.place - a)) / most : 0.0; };
  pick(2, area, equal * size * norm(along));
  pick(3, [&](const FacePoint& p) { return -area(p); }, equal * size * norm(along));
  for (std::size_t k = spanning; k < most_points; ++k)
    pick(
        k,
        [&](const FacePoint& p) {
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t i = 0; i < k; ++i) least = std::min(least, norm(p.place - points_[i].place));
          return least;
        },
        equal * size);
  points_.resize(most_points);
}

}  // namespace iota::contact
