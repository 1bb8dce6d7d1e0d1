// SPDX-License-Identifier: Apache-2.0
#include "contact/round_touches.h"

#include "contact/round_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace iota::contact {

namespace {

constexpr double face_sine = 5e-3;      ///< of normals that count as the same
constexpr double side_sine = 1e-3;      ///< of a normal at right angles to an axis
constexpr double lying_sine = 0.5;      ///< of a cylinder's axis with a plane's normal, above which it rolls on a rim
constexpr double standing_sine = 1e-3;  ///< below which no point of a rim is the lowest one
constexpr double settled_overlap_share = 1e-4;
constexpr double nearly_same = 1e-7;                           ///< of the size
constexpr double same_separation = 1e-9;                       ///< of the size
constexpr std::uint32_t lowest_of_rim = 64, ball_of_rim = 66;  ///< numbers of features, for both rims

/// The ball that touches a rim from within, or the lowest point of the rim, seen along `down`.
Clipper::End end_of_rim(const ConvexPart& part, const Vec3& center, std::uint32_t rim, const Vec3& down) {
  const double along = dot(down, part.axes[0]), across = std::sqrt(std::max(0.0, 1 - along * along)),
               ring = part.half.y;
  if (across > lying_sine)
    return {
        center - (ring * along / across) * part.axes[0], ring / across + part.radius, {part.number, ball_of_rim + rim}};
  const Vec3 out = across > 0 ? (ring / across) * (down - along * part.axes[0]) : ring * part.axes[1];
  return {center + out, part.radius, {part.number, lowest_of_rim + rim}};
}

struct Ball {
  Vec3 center;
  double radius;
};

/// A ball that is as curved as an ellipsoid along the way that it rolls, where it touches in the middle of the step: the place that
/// touches at its begin made rolling one of first order.
Ball ball_of(const ConvexPart& part, const Vec3& direction) {
  const Vec3 turned = direction - cross(part.spin, direction), down = (1 / norm(turned)) * turned;
  const auto local = [&](const Vec3& v) {
    return Vec3{dot(v, part.axes[0]), dot(v, part.axes[1]), dot(v, part.axes[2])};
  };
  const Vec3 &half = part.half, d = local(down), s = local(part.spin);
  const Vec3 scaled{half.x * d.x, half.y * d.y, half.z * d.z};
  const Vec3 twice{half.x * scaled.x, half.y * scaled.y, half.z * scaled.z};
  const double reach = norm(scaled), cubed = reach * reach * reach;
  // By the Hessian of the support function |A d|: along t, or the mean.
  const Vec3 t = cross(s, d), a{half.x * t.x, half.y * t.y, half.z * t.z};
  const double along = dot(twice, t), squared = dot(t, t);
  const double curved = squared > 0 ? (dot(a, a) / reach - along * along / cubed) / squared
                                    : 0.5 * (dot(half, half) / reach - dot(twice, twice) / cubed);
  const double radius = std::clamp(curved, 0.0, dot(half, half) / std::min({half.x, half.y, half.z}));
  return {farthest(part, down) - radius * down, radius};
}

void set_ball(const ConvexPart& part, const Vec3& direction, ConvexPart& ball) {
  const auto [center, radius] = ball_of(part, direction);
  ball.radius = radius, ball.number = part.number, ball.is_line = false;
  set_segment(center, center, ball);
}

/// A polytope, rod or ball that has the same surface near the place where the part is farthest down, if there is one.
const ConvexPart* simple_of(const ConvexPart& part, const Vec3& down, ConvexPart& simple) {
  if (part.is_polytope()) return &part;
  if (part.kind == ConvexPart::Kind::ellipsoid) {
    set_ball(part, down, simple);
    return &simple;
  }
  if (part.kind == ConvexPart::Kind::cone || std::abs(dot(down, part.axes[0])) > side_sine) return nullptr;
  simple.radius = part.radius + part.half.y, simple.number = part.number, simple.is_line = false;
  const Vec3 half = part.half.x * part.axes[0];
  set_segment(part.middle - half, part.middle + half, simple);
  return &simple;
}

std::uint32_t name_of_place(const ConvexPart& part, const Vec3& down) {
  if (part.is_polytope()) return part.support(down);
  return lowest_of_rim + (dot(down, part.axes[0]) > 0 ? 1 : 0);
}

/// How much lower than every other of its corners a rim may be that nearly lies in a plane: its lowest point is left out.
double drop_of_rim(const ConvexPart& part, const Vec3& normal) {
  if (part.kind != ConvexPart::Kind::cylinder && part.kind != ConvexPart::Kind::cone) return 0;
  const double across = norm(cross(normal, part.axes[0]));
  if (across > standing_sine) return 0;
  return across * part.half.y * (1 - std::cos(2 * std::numbers::pi / corners_of_rim));
}

/// How much nearer or farther the ball of a turning ellipsoid is than the ellipsoid itself, which it touches in the middle of the
/// step: without it what rolled fast touched with a place instead of a ball, and an egg went a body's length wrong in a second.
double error_of_ball(const ConvexPart& part, const Vec3& down) {
  if (part.kind != ConvexPart::Kind::ellipsoid) return 0;
  const auto [center, radius] = ball_of(part, down);
  return std::abs(dot(down, farthest(part, down) - center) - radius);
}

double least_gap(const std::vector<Touch>& found, std::size_t begin) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = begin; k < found.size(); ++k) least = std::min(least, found[k].gap);
  return least;
}

}  // namespace

std::uint32_t face_along(const ConvexPart& part, const Vec3& direction) {
  const std::size_t count = part.kind == ConvexPart::Kind::cylinder ? 2
                            : part.kind == ConvexPart::Kind::cone   ? 1
                                                                    : part.normals.size();
  std::uint32_t best = Polytope::none;
  double least = face_sine * face_sine;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec3 off = part.normals[f] - direction;
    if (const double squared = dot(off, off); squared < least) least = squared, best = f;
  }
  return best;
}

void add_touches_of_polytopes(const ConvexPart& first, const ConvexPart& second, const Vec3& way, TouchWriter& writer,
                              Clipper& clipper) {
  if (first.normals.empty() && second.normals.empty()) return add_touches_of_segments(writer);
  const double radius = first.radius + second.radius;
  const std::optional<Axis> axis = find_axis(first, second, way, writer.within() + radius);
  if (!axis) return;
  if (radius > 0 && axis->most_apart > 0 && add_touches_of_corners(writer, axis->most_apart)) return;
  clipper.add_touches(*axis, writer, 4);
}

void RoundToucher::add_touches(const ConvexPart& first, const ConvexPart& second, const Vec3& anchor, double within,
                               std::vector<Touch>& found) {
  const double radius = first.radius + second.radius, size = std::min(first.size, second.size);
  first_ = &first, second_ = &second;
  const std::size_t before = found.size();
  const auto try_faces = [&](const RoundAxis& axis) {
    const double most = axis.apart - radius + same_separation * size + 2e-5 * std::abs(axis.apart) +
                        drop_of_rim(first, axis.normal) + drop_of_rim(second, axis.normal) +
                        error_of_ball(first, -axis.normal) + error_of_ball(second, axis.normal);
    for (const bool is_of_first : {false, true}) {
      if (add_on_face(axis, is_of_first, anchor, within, found) && least_gap(found, before) <= most) return true;
      found.resize(before);
    }
    return false;
  };
  const RoundAxis guessed = guess_round_axis(first, second);
  // If the nearest point is over the face, no other direction is better.
  if (guessed.apart > within + radius) return;
  if (guessed.apart > -settled_overlap_share * size && try_faces(guessed)) return;
  const std::optional<RoundAxis> axis = find_round_axis(first, second, guessed, within + radius);
  if (!axis || try_faces(*axis)) return;
  if (add_simple(*axis, anchor, within, found)) {
    // They are those of the parts if the parts are as far apart along the same normal.
    const Touch& least = *std::min_element(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(),
                                           [](const Touch& a, const Touch& b) { return a.gap < b.gap; });
    const double apart = apart_along(first, second, least.is_turned ? -least.normal : least.normal);
    if (std::abs(apart - radius - least.gap) <= same_separation * size && apart >= axis->apart - nearly_same * size)
      return;
  }
  found.resize(before);
  const Vec3 off = axis->on_first - axis->on_second;
  const Vec3 on_second = axis->on_second + (dot(axis->normal, off) - axis->apart) * axis->normal;
  TouchWriter(first, second, anchor, within, found)
      .add_edges(axis->on_first, on_second, axis->normal,
                 {first.is_line ? first.end.part : first.number, name_of_place(first, -axis->normal)},
                 {second.is_line ? second.end.part : second.number, name_of_place(second, axis->normal)});
}

void RoundToucher::add_on_face_of_second(const ConvexPart& first, const ConvexPart& second, const Vec3& normal,
                                         const Vec3& anchor, double within, std::vector<Touch>& found) {
  first_ = &first, second_ = &second;
  (void)add_on_face({.normal = normal}, false, anchor, within, found);
}

/// With the plane of a face of one of them. False: there is no such face, or the other one is beside it.
bool RoundToucher::add_on_face(const RoundAxis& round, bool is_of_first, const Vec3& anchor, double within,
                               std::vector<Touch>& found) {
  const ConvexPart &owner = is_of_first ? *first_ : *second_, &other = is_of_first ? *second_ : *first_;
  const std::uint32_t face = face_along(owner, is_of_first ? -round.normal : round.normal);
  if (face == Polytope::none) return false;
  const Vec3& normal = owner.normals[face];
  Axis axis{
      .kind = is_of_first ? Axis::Kind::face_of_first : Axis::Kind::face_of_second, .first = face, .second = face};
  axis.normal = is_of_first ? -normal : normal;
  axis.apart = axis.most_apart = apart_along(*first_, *second_, axis.normal);
  axis.is_farthest = false;
  const std::size_t before = found.size();
  TouchWriter writer(*first_, *second_, anchor, within, found);
  const double along = std::abs(dot(normal, other.axes[0])), across = std::sqrt(std::max(0.0, 1 - along * along));
  if (other.is_polytope()) {
    clipper_.add_touches(axis, writer, 6);
  } else if (other.kind == ConvexPart::Kind::ellipsoid) {
    ConvexPart& ball = is_of_first ? simple_second_ : simple_first_;
    set_ball(other, -normal, ball);
    TouchWriter of_ball(is_of_first ? *first_ : ball, is_of_first ? ball : *second_, anchor, within, found);
    clipper_.add_touches(axis, of_ball, 1);
  } else {
    const Vec3 half = other.half.x * other.axes[0];
    const bool is_cone = other.kind == ConvexPart::Kind::cone;
    const Clipper::End low = end_of_rim(other, other.middle - half, 0, -normal);
    const Clipper::End high = is_cone ? Clipper::End{other.middle + half, other.radius, {other.number, ball_of_rim + 1}}
                                      : end_of_rim(other, other.middle + half, 1, -normal);
    if (across > lying_sine) return clipper_.add_rod(axis, low, high, {other.number, 1u << 28}, writer);
    const bool is_high = dot(normal, other.axes[0]) < 0;
    if (across > standing_sine || (is_cone && is_high))
      clipper_.add_rod(axis, is_high ? high : low, is_high ? high : low, {}, writer);
    if (!(is_cone && is_high)) clipper_.add_touches(axis, writer, found.size() > before ? 5 : 6);
  }
  return found.size() > before;
}

/// With balls and rods instead of what is round.
bool RoundToucher::add_simple(const RoundAxis& axis, const Vec3& anchor, double within, std::vector<Touch>& found) {
  const ConvexPart* const first = simple_of(*first_, -axis.normal, simple_first_);
  const ConvexPart* const second = simple_of(*second_, axis.normal, simple_second_);
  if (!first || !second) return false;
  const std::size_t before = found.size();
  TouchWriter writer(*first, *second, anchor, within, found);
  add_touches_of_polytopes(*first, *second, {}, writer, clipper_);
  return found.size() > before;
}

}  // namespace iota::contact
