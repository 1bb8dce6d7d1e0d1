// SPDX-License-Identifier: Apache-2.0
#include "contact/corner_touches.h"

#include "contact/ring_sides.h"
#include "math/mat3.h"
#include "shape/shape_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <variant>

namespace iota::contact {

namespace {

/// Sine of the tilt of a disk below which it lies rather than rolls: the ball that touches its rim all around is then far
/// away, so that its distance would change too much with the tilt.
constexpr double lying = 0.5;
constexpr std::uint32_t points_of_rim = 6;
constexpr double vanishing = 1e-7, offset = 1e-3;  ///< of a size: see plane_of
constexpr double same_normal = 1e-6;
constexpr double beside = 1e-3;  ///< of the size: what is so little beside a face is still over it

struct Plane {
  Vec3 origin, normal;
  std::uint32_t side = 0;  ///< of a mesh: see side_of
};

/// A face of a mesh near a body.
struct Face {
  const Solid& solid;
  Plane plane;
  Vec3 corners[3];

  Face turned_over() const {
    return {solid, {plane.origin, -plane.normal, plane.side ^ 1}, {corners[0], corners[1], corners[2]}};
  }
};

Vec3 unit(const Vec3& v) { return (1 / norm(v)) * v; }

double size_of(const Form& form) { return form.is_endless ? 1 : norm(form.box.high - form.box.low); }

/// Whether an open mesh is between two places.
bool is_between(const geometry::TriangleTree& mesh, const Vec3& from, const Vec3& place) {
  const double far = norm(place - from);
  return far > 0 && mesh.ray(from, (1 / far) * (place - from), far).has_value();
}

/// One of six sides of a mesh, two opposite ones after each other, by which touches with its faces are named: what slides or rolls on
/// many triangles keeps its touch, and has another one with a wall. The axes are in no symmetry of a usual mesh.
std::uint32_t side_of(const Vec3& local_normal) {
  const Quaternion askew = normalized(Quaternion{0.07, 0.11, 0.05, 1});
  const Vec3 n = rotate(askew, local_normal), size{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  if (size.y >= size.x && size.y >= size.z) return n.y > 0 ? 0 : 1;
  if (size.x >= size.z) return n.x > 0 ? 2 : 3;
  return n.z > 0 ? 4 : 5;
}

/// visit(face): of meshes, those that may be at most `within` away from a place of a body, on the side of its middle if they are open.
template <class Visit>
void visit_faces(const PartList& other, const Vec3& place, double within, const Vec3& middle, Visit visit) {
  for (const Solid* const solid : other.solids) {
    const auto& mesh = solid->form->mesh;
    if (!mesh) continue;
    const Quaternion back = conjugate(solid->turn);
    const Vec3 local = rotate(back, place - solid->position), inside = rotate(back, middle - solid->position);
    const auto to_world = [&](const Vec3& p) { return solid->position + rotate(solid->turn, p); };
    mesh->near(local, within, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      Vec3 normal = unit_or(cross(b - a, c - a), {});
      if (!mesh->is_closed() && dot(normal, inside - a) < 0) normal = -normal;
      if (normal == Vec3{} || !(std::abs(dot(normal, local - a)) <= within)) return;
      visit(Face{*solid,
                 {to_world(a), rotate(solid->turn, normal), side_of(normal)},
                 {to_world(a), to_world(b), to_world(c)}});
    });
  }
}

/// visit(plane): of half-spaces.
template <class Visit>
void visit_half_spaces(const PartList& other, Visit visit) {
  for (const Solid* const solid : other.solids)
    if (solid->form->is_endless) visit(Plane{solid->position, outwards(*solid)});
}

/// Whether a place is over a face, or so little beside it.
bool is_over(const Face& face, const Vec3& place, double beside) {
  const Vec3 around = cross(face.corners[1] - face.corners[0], face.corners[2] - face.corners[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &from = face.corners[k], along = face.corners[(k + 1) % 3] - from;
    if (dot(cross(along, place - from), around) < -beside * norm(along) * norm(around)) return false;
  }
  return true;
}

/// The plane that touches a solid nearest to a place of a body, whose middle is outside. A place on the surface says nothing
/// about the normal: a place a little nearer to the middle does. An open mesh has its outside where the middle is, beyond
/// which it is only where it is between both: the end of a beam that lies on a rail is not in it.
std::optional<Plane> plane_of(const Solid& solid, const Vec3& place, const Vec3& middle) {
  const Form& form = *solid.form;
  const Quaternion back = conjugate(solid.turn);
  const Vec3 local = rotate(back, place - solid.position);
  if (form.is_endless) return Plane{solid.position, outwards(solid)};
  const double size = size_of(form);
  const Vec3 point = closest(form, local), outwards = rotate(back, middle - solid.position) - point;
  Vec3 away = local - point;
  if (!(norm(away) > vanishing * size)) {
    if (!(norm(outwards) > vanishing * size)) return {};
    const Vec3 further = point + std::min(1.0, offset * size / norm(outwards)) * outwards;
    away = further - closest(form, further);
    if (!(norm(away) > 0)) return {};
  } else if (form.mesh && !form.mesh->is_closed()
                 ? dot(away, outwards) < 0 && is_between(*form.mesh, point + outwards, local)
                 : is_within(form, local)) {
    away = -1.0 * away;
  }
  return Plane{solid.position + rotate(solid.turn, point), rotate(solid.turn, unit(away)),
               form.mesh ? side_of(unit(away)) : 0};
}

std::optional<Plane> plane_of(const Line& line, const Vec3& place) {
  const Vec3 middle = nearest_of_middle(line, place);
  if (!(norm(place - middle) > 0)) return {};
  const Vec3 normal = unit(place - middle);
  return Plane{middle + line.radius * normal, normal};
}

/// The plane of the part that is nearest to a place of a body.
std::optional<Plane> plane_of(const PartList& other, const Vec3& place, const Vec3& middle) {
  std::optional<Plane> best;
  double least = 0;
  const auto take = [&](const std::optional<Plane>& plane) {
    if (!plane) return;
    const double apart = dot(plane->normal, place - plane->origin);
    if (!best || apart < least) best = plane, least = apart;
  };
  for (const Solid* const solid : other.solids) take(plane_of(*solid, place, middle));
  for (const Line* const line : other.lines) take(plane_of(*line, place));
  return best;
}

/// Whether no other face is nearer to a place behind this one.
bool is_nearest(const Face& face, const Vec3& place, double depth, double tolerance) {
  const Vec3 local = to_local(face.solid, place);
  return depth <= norm(local - closest(*face.solid.form, local)) + tolerance;
}

/// Whether a place is in a closed mesh, or parted by an open one from the middle of its body.
bool is_through(const Solid& solid, const Vec3& place, const Vec3& middle) {
  const Vec3 local = to_local(solid, place);
  return solid.form->mesh->is_closed() ? is_within(*solid.form, local)
                                       : is_between(*solid.form->mesh, to_local(solid, middle), local);
}

/// Whether a place is in front of a face, over it, with no other face between both.
bool is_in_front(const Face& face, const Vec3& place, double tolerance) {
  const double height = dot(face.plane.normal, place - face.plane.origin);
  if (!(height > tolerance)) return false;
  const Vec3 down = rotate(conjugate(face.solid.turn), -face.plane.normal);
  return !face.solid.form->mesh->ray(to_local(face.solid, place), down, height - tolerance);
}

/// Touches of one feature with faces of one side are numbered in the same order when the body moves along them.
void number_touches(std::span<Touch> touches) {
  constexpr std::uint32_t sides = 8;
  constexpr Vec3 order{0.48, 0.61, 0.63};
  const auto plane_name = [](Touch& touch) -> std::uint32_t& {
    return touch.is_turned ? touch.feature : touch.other_feature;
  };
  const auto is_same = [](const Touch& a, const Touch& b) {
    return a.part == b.part && a.feature == b.feature && a.other_part == b.other_part &&
           a.other_feature == b.other_feature;
  };
  thread_local std::vector<std::uint32_t> ranks;
  ranks.clear();
  for (const Touch& touch : touches)
    ranks.push_back(static_cast<std::uint32_t>(std::ranges::count_if(touches, [&](const Touch& other) {
      return is_same(touch, other) && dot(other.normal, order) < dot(touch.normal, order);
    })));
  for (std::size_t k = 0; k < touches.size(); ++k) plane_name(touches[k]) += sides * ranks[k];
}

geometry::Bounds bounds_of(const PartList& parts) {
  constexpr double far = std::numeric_limits<double>::infinity();
  geometry::Bounds all{{far, far, far}, {-far, -far, -far}};
  for (const Solid* const solid : parts.solids) {
    if (solid->form->is_endless) return {{-far, -far, -far}, {far, far, far}};
    all = geometry::joined(all, bounds(*solid, {}));
  }
  for (const Line* const line : parts.lines) all = geometry::joined(all, bounds(*line, {}));
  return all;
}

/// A ball of the outline: its corner, its end, or the ball that touches a rim from within, where it is lowest.
struct Feature {
  std::uint32_t number;
  Vec3 center;
  double radius;
  bool is_lowest = false;       ///< in the direction that was asked for; others are fixed on the body
  std::optional<Rim> rim = {};  ///< that lies, in the shape's frame
};

/// A circle around an axis, with a wire of some radius: of a disk's rim, of a torus.
template <class Visit>
void visit_rim(std::uint32_t number, const Vec3& center, const Vec3& axis, double radius, double wire, const Vec3& down,
               Visit visit) {
  const double along = dot(down, axis), across = std::sqrt(std::max(0.0, 1 - along * along));
  // The normal through the lowest point meets the axis in the center of a ball that touches the circle all around, so that
  // what rolls keeps its distance.
  if (across > lying) return visit({number, center - (radius * along / across) * axis, radius / across + wire, true});
  const double least = 1e-3;
  if (across > least) visit({number, center + (radius / across) * (down - along * axis), wire, true});
  const Vec3 side = unit(any_perpendicular(axis)), third = cross(axis, side);
  std::optional<Rim> lies;
  if (!(across > least)) lies = Rim{center, radius * side, radius * third, number};
  for (std::uint32_t k = 0; k < points_of_rim; ++k) {
    const double turn = 2 * std::numbers::pi * k / points_of_rim;
    visit({number + 1 + k, center + radius * (std::cos(turn) * side + std::sin(turn) * third), wire, false, lies});
  }
}

/// visit(feature): in the shape's frame, of those that may be nearest to a plane in the direction `down`. What is round in
/// several ways is as round as along the way that it rolls, where it touches in the middle of the step. turn: of half a step, rad.
template <class Visit>
void visit_features(const Shape& shape, const Vec3& down, const Vec3& turn, Visit visit) {
  constexpr std::uint32_t rim = 1 + points_of_rim;  // numbers
  if (const auto* const s = std::get_if<Sphere>(&shape)) {
    visit({0, {}, s->radius});
  } else if (const auto* const b = std::get_if<Box>(&shape)) {
    const Vec3 half = 0.5 * b->size - Vec3{b->rounding, b->rounding, b->rounding};
    for (std::uint32_t k = 0; k < 8; ++k)
      visit({k, {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z}, b->rounding});
  } else if (const auto* const c = std::get_if<Capsule>(&shape)) {
    for (std::uint32_t k = 0; k < 2; ++k) visit({k, {(k ? 0.5 : -0.5) * c->length, 0, 0}, c->radius});
  } else if (const auto* const c = std::get_if<Cylinder>(&shape)) {
    for (std::uint32_t k = 0; k < 2; ++k)
      visit_rim(rim * k, {(k ? 1 : -1) * (0.5 * c->length - c->rounding), 0, 0}, {1, 0, 0}, c->radius - c->rounding,
                c->rounding, down, visit);
  } else if (const auto* const c = std::get_if<Cone>(&shape)) {
    visit({rim, {0.5 * c->length, 0, 0}, 0.0});
    visit_rim(0, {-0.5 * c->length, 0, 0}, {1, 0, 0}, c->radius, 0, down, visit);
  } else if (const auto* const t = std::get_if<Torus>(&shape)) {
    for (std::uint32_t k = 0; k < (t->stretch > 0 ? 2u : 1u); ++k)
      visit_rim(rim * k, {(k ? 0.5 : -0.5) * t->stretch, 0, 0}, {0, 0, 1}, t->radius, t->tube, down, visit);
  } else if (const auto* const e = std::get_if<Ellipsoid>(&shape)) {
    const Vec3 half = 0.5 * e->size, ahead = unit(down - cross(turn, down));
    const Vec3 scaled{half.x * ahead.x, half.y * ahead.y, half.z * ahead.z};
    const Vec3 twice{half.x * scaled.x, half.y * scaled.y, half.z * scaled.z};
    const double reach = norm(scaled);
    // The radius of curvature, by the Hessian of the support function |A d|: along t, or the mean.
    const Vec3 t = cross(turn, ahead), a{half.x * t.x, half.y * t.y, half.z * t.z};
    const double along = dot(twice, t), squared = dot(t, t), cubed = reach * reach * reach;
    const double radius = squared > 0 ? (dot(a, a) / reach - along * along / cubed) / squared
                                      : 0.5 * (dot(half, half) / reach - dot(twice, twice) / cubed);
    const double ball = std::clamp(radius, 0.0, dot(half, half) / std::min({half.x, half.y, half.z}));
    visit({0, (1 / reach) * twice - ball * ahead, ball, true});
  }
}

/// A ball of a body: a corner, an end, or what a feature of it touches with.
struct Ball {
  std::uint32_t part, feature;
  Vec3 center;
  double radius;
  std::optional<Rim> rim = {};
};

/// The touches of a body with other parts, found part by part.
class CornerSearch {
 public:
  CornerSearch(const PartList& other, double within, const CornerFinder::Names& names, std::vector<Touch>& found)
      : other_(other), within_(within), names_(names), found_(found), before_(found.size()) {}

  void find_of_mesh(const Solid&, const std::vector<Vec3>& corners);
  void find_of_shape(const Solid&, const Vec3& spin);
  void find_of_lines(const std::vector<const Line*>&);
  /// The new ones, in a fixed order.
  std::span<Touch> found() { return std::span(found_).subspan(before_); }

 private:
  void start(const Solid& solid) {
    const geometry::Bounds& box = solid.form->box;
    middle_ = solid.position + rotate(solid.turn, 0.5 * (box.low + box.high)), size_ = size_of(*solid.form);
    const Vec3 half = 0.5 * (box.high - box.low);
    thickness_ = std::min({half.x, half.y, half.z});
  }
  /// How far the part goes on behind the place with which its ball touches.
  double inside(const Ball& ball) const { return std::min(ball.radius, thickness_); }
  /// If its gap is small enough, and it is not known.
  void add(const Ball&, const Plane&);
  /// Whether the middle of the part, which is convex, is behind a face and outside of its mesh: the part is beyond an edge of
  /// the face, and would be pulled through the edge.
  bool is_behind(const Face&) const;
  /// In a corner of a room a feature touches three faces: all count, not only the nearest one.
  void add_on_face(const Ball&, const Face&);
  /// The lowest place of a rim above a face may be beneath the next one, where both are in a valley.
  void add_beneath_valley(const Ball& lowest, const Face&);
  /// A ring has its wire on both sides of an open mesh.
  void add_of_ring(const Ball&, double tube, const RingSides&, const Face&);
  /// With the nearest place, all half-spaces and all near faces.
  void look(const Ball&);

  const PartList& other_;
  double within_;
  const CornerFinder::Names& names_;
  std::vector<Touch>& found_;
  std::size_t before_;
  Vec3 middle_;                      ///< of the part
  double size_ = 0, thickness_ = 0;  ///< thickness: half of the least, m
};

void CornerSearch::add(const Ball& ball, const Plane& plane) {
  const double gap = dot(plane.normal, ball.center - plane.origin) - ball.radius;
  if (!(gap <= within_)) return;
  Touch touch;
  touch.part = ball.part, touch.feature = ball.feature, touch.other_feature = names_.planes + plane.side;
  if (names_.is_turned) std::swap(touch.part, touch.other_part), std::swap(touch.feature, touch.other_feature);
  touch.is_turned = names_.is_turned;
  touch.center = ball.center, touch.place = ball.center - ball.radius * plane.normal;
  touch.origin = plane.origin, touch.normal = plane.normal, touch.radius = ball.radius, touch.gap = gap;
  touch.rim = ball.rim;
  const bool is_known = std::ranges::any_of(found(), [&](const Touch& one) {
    return one.part == touch.part && one.other_part == touch.other_part &&
           norm(one.normal - touch.normal) <= same_normal &&
           (names_.is_turned ? one.other_feature == touch.other_feature : one.feature == touch.feature);
  });
  if (!is_known) found_.push_back(touch);
}

bool CornerSearch::is_behind(const Face& face) const {
  if (!(dot(face.plane.normal, middle_ - face.plane.origin) < 0)) return false;
  return !is_within(*face.solid.form, to_local(face.solid, middle_));
}

void CornerSearch::add_on_face(const Ball& ball, const Face& face) {
  const Vec3& normal = face.plane.normal;
  const double gap = dot(normal, ball.center - face.plane.origin) - ball.radius, tolerance = vanishing * size_;
  const Vec3 place = ball.center - ball.radius * normal;
  if (!(gap <= within_) || !is_over(face, place, beside * size_)) return;
  // A corner is in the face that is nearest to it. A ball near a ridge is on the face beneath it, though its lowest place may be nearer
  // to the next face, which the ball does not meet: balls sank in at the rim of a hole.
  if (gap < -tolerance && !is_in_front(face, place + inside(ball) * normal, tolerance) &&
      !(is_nearest(face, place, -gap, tolerance) && is_through(face.solid, place, middle_)))
    return;
  add(ball, face.plane);
}

void CornerSearch::add_beneath_valley(const Ball& lowest, const Face& face) {
  const Vec3 &normal = face.plane.normal, place = lowest.center - lowest.radius * normal;
  if (!(dot(normal, place - face.plane.origin) < 0) || is_over(face, place, 0)) return;
  const std::optional<Plane> next = plane_of(other_, place, middle_);
  if (!next || !(dot(next->normal, place - next->origin) < 0)) return;
  const Vec3 middle_of_face = (1.0 / 3) * (face.corners[0] + face.corners[1] + face.corners[2]);
  if (dot(next->normal, middle_of_face - next->origin) > vanishing * size_)
    add({lowest.part, lowest.feature, place, 0}, *next);
}

void CornerSearch::add_of_ring(const Ball& ball, double tube, const RingSides& sides, const Face& face) {
  const Vec3 &normal = face.plane.normal, place = ball.center - ball.radius * normal;
  const double gap = dot(normal, place - face.plane.origin), tolerance = vanishing * size_;
  if (!(gap <= within_) || !is_over(face, place, beside * size_)) return;
  if (gap < -tolerance && !is_nearest(face, place, -gap, tolerance)) return;
  if (sides.is_through(place + tube * normal) == (gap < -tube)) add(ball, face.plane);
}

void CornerSearch::look(const Ball& ball) {
  if (const std::optional<Plane> plane = plane_of(other_, ball.center, middle_)) add(ball, *plane);
  visit_half_spaces(other_, [&](const Plane& plane) { add(ball, plane); });
  visit_faces(other_, ball.center, ball.radius + within_, middle_, [&](const Face& face) { add_on_face(ball, face); });
}

void CornerSearch::find_of_mesh(const Solid& solid, const std::vector<Vec3>& corners) {
  start(solid);
  const geometry::Bounds around = geometry::grown(bounds_of(other_), within_);
  for (std::uint32_t k = 0; k < corners.size(); ++k)
    if (const Vec3 corner = solid.position + rotate(solid.turn, corners[k]); geometry::distance(around, corner) <= 0)
      look({solid.number, k, corner, 0});
}

void CornerSearch::find_of_shape(const Solid& solid, const Vec3& spin) {
  start(solid);
  const Shape& shape = solid.form->shape;
  const Quaternion back = conjugate(solid.turn);
  const Vec3 turn = rotate(back, spin);
  const auto visit_lowest_above = [&](const Plane& beneath, auto visit) {
    visit_features(shape, rotate(back, -1.0 * beneath.normal), turn, [&](const Feature& feature) {
      const Vec3 center = solid.position + rotate(solid.turn, feature.center);
      Ball ball{solid.number, feature.number, center, feature.radius};
      if (feature.rim)
        ball.rim = Rim{solid.position + rotate(solid.turn, feature.rim->middle), rotate(solid.turn, feature.rim->first),
                       rotate(solid.turn, feature.rim->second), feature.rim->name};
      visit(ball, feature.is_lowest);
    });
  };
  visit_half_spaces(other_, [&](const Plane& plane) {
    visit_lowest_above(plane, [&](const Ball& ball, bool) { add(ball, plane); });
  });
  std::uint32_t looked = 0;  // bits of features
  std::optional<RingSides> sides;
  const Solid* sides_of = nullptr;
  const auto* const torus = std::get_if<Torus>(&shape);
  const bool has_rim = std::holds_alternative<Cylinder>(shape) || std::holds_alternative<Cone>(shape);
  visit_faces(other_, middle_, 0.5 * size_ + within_, middle_, [&](const Face& face) {
    if (torus && !face.solid.form->mesh->is_closed()) {
      if (sides_of != &face.solid) sides.emplace(solid, face.solid), sides_of = &face.solid;
      for (const Face& one : {face, face.turned_over()})
        visit_lowest_above(one.plane, [&](const Ball& ball, bool) { add_of_ring(ball, torus->tube, *sides, one); });
      return;
    }
    if (!torus && is_behind(face)) return;
    visit_lowest_above(face.plane, [&](const Ball& ball, bool is_lowest) {
      add_on_face(ball, face);
      if (is_lowest && has_rim) add_beneath_valley(ball, face);
      // Beneath the bottom of a valley a corner is over none of its faces.
      const bool may_be_in = !is_lowest && dot(face.plane.normal, ball.center - face.plane.origin) < 0;
      if (!may_be_in || (looked >> ball.feature & 1)) return;
      looked |= 1u << ball.feature;
      const std::optional<Plane> plane = plane_of(other_, ball.center, middle_);
      if (plane && dot(plane->normal, ball.center - plane->origin) < 0) add(ball, *plane);
    });
  });
}

void CornerSearch::find_of_lines(const std::vector<const Line*>& lines) {
  middle_ = {};
  for (const Line* const line : lines) middle_ += (0.5 / static_cast<double>(lines.size())) * (line->a + line->b);
  const auto look_once = [&](std::uint32_t particle, const Vec3& place, double radius) {  // lines share points
    const bool is_known = std::ranges::any_of(
        found(), [&](const Touch& touch) { return (names_.is_turned ? touch.other_part : touch.part) == particle; });
    if (!is_known) look({particle, 0, place, radius});
  };
  for (const Line* const line : lines) {
    size_ = thickness_ = line->radius;
    look_once(line->p, line->a, line->radius), look_once(line->q, line->b, line->radius);
  }
}

}  // namespace

const std::vector<Vec3>& CornerFinder::corners_of(const std::shared_ptr<const Form>& form) {
  return corners_.of(form, [&] { return convex_hull(form->mesh->vertices()).vertices; });
}

void CornerFinder::find(const PartList& body, const Vec3& spin, const PartList& other, double within,
                        const Names& names, std::vector<Touch>& found) {
  if (body.is_empty() || other.is_empty()) return;
  CornerSearch search(other, within, names, found);
  for (const Solid* const solid : body.solids)
    if (solid->form->mesh)
      search.find_of_mesh(*solid, corners_of(solid->form));
    else if (!solid->form->is_endless)
      search.find_of_shape(*solid, spin);
  search.find_of_lines(body.lines);
  number_touches(search.found());
}

}  // namespace iota::contact
