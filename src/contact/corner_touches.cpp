// SPDX-License-Identifier: Apache-2.0
#include "contact/corner_touches.h"

#include "math/mat3.h"
#include "shape/shape_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <variant>

namespace iota::contact {

namespace {

/// Sine of the tilt of a disk below which it lies rather than rolls: the ball that touches its rim all around is then far
/// away, so that its distance would change too much with the tilt.
constexpr double lying = 0.5;
constexpr std::uint32_t points_of_rim = 6;
constexpr double vanishing = 1e-7, offset = 1e-3;  ///< of a size: see plane_of
constexpr double same_normal = 1e-6;

struct Plane {
  Vec3 origin, normal;
};

Vec3 unit(const Vec3& v) { return (1 / norm(v)) * v; }

double size_of(const Form& form) { return form.is_endless ? 1 : norm(form.box.high - form.box.low); }

/// Whether an open mesh is between two places.
bool is_behind(const geometry::TriangleTree& mesh, const Vec3& from, const Vec3& place) {
  const double far = norm(place - from);
  return far > 0 && mesh.ray(from, (1 / far) * (place - from), far).has_value();
}

/// The plane that touches a solid nearest to a place of a body, whose middle is outside. A place on the surface says nothing
/// about the normal: a place a little nearer to the middle does. An open mesh has its outside where the middle is, beyond
/// which it is only where it is between both: the end of a beam that lies on a rail is not in it.
std::optional<Plane> plane_of(const Solid& solid, const Vec3& place, const Vec3& middle) {
  const Form& form = *solid.form;
  const Quaternion back = conjugate(solid.turn);
  const Vec3 local = rotate(back, place - solid.position);
  if (const auto* const half = std::get_if<HalfSpace>(&form.shape)) {
    const Vec3 normal = rotate(solid.turn, unit(half->normal));
    return Plane{solid.position, normal};
  }
  const double size = size_of(form);
  const Vec3 point = closest(form, local), outwards = rotate(back, middle - solid.position) - point;
  Vec3 away = local - point;
  if (!(norm(away) > vanishing * size)) {
    if (!(norm(outwards) > vanishing * size)) return {};
    const Vec3 further = point + std::min(1.0, offset * size / norm(outwards)) * outwards;
    away = further - closest(form, further);
    if (!(norm(away) > 0)) return {};
  } else if (form.mesh && !form.mesh->is_closed()
                 ? dot(away, outwards) < 0 && is_behind(*form.mesh, point + outwards, local)
                 : is_within(form, local)) {
    away = -1.0 * away;
  }
  return Plane{solid.position + rotate(solid.turn, point), rotate(solid.turn, unit(away))};
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
  bool is_lowest = false;  ///< in the direction that was asked for; others are fixed on the body
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
  for (std::uint32_t k = 0; k < points_of_rim; ++k) {
    const double turn = 2 * std::numbers::pi * k / points_of_rim;
    visit({number + 1 + k, center + radius * (std::cos(turn) * side + std::sin(turn) * third), wire});
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

}  // namespace

const std::vector<Vec3>& CornerFinder::corners_of(const std::shared_ptr<const Form>& form) {
  return corners_.of(form, [&] { return convex_hull(form->mesh->vertices()).vertices; });
}

void CornerFinder::find(const PartList& body, const Vec3& spin, const PartList& other, double within,
                        const Names& names, std::vector<Touch>& found) {
  if (body.is_empty() || other.is_empty()) return;
  Vec3 middle;
  for (const Line* const line : body.lines)
    middle += (0.5 / static_cast<double>(body.lines.size())) * (line->a + line->b);
  const std::size_t before = found.size();
  const auto add = [&](std::uint32_t part, std::uint32_t feature, const Vec3& center, double radius,
                       const std::optional<Plane>& plane) {
    if (!plane) return;
    const double gap = dot(plane->normal, center - plane->origin) - radius;
    if (!(gap <= within)) return;
    Touch touch;
    touch.part = part, touch.feature = feature, touch.other_feature = names.planes;
    if (names.is_turned) std::swap(touch.part, touch.other_part), std::swap(touch.feature, touch.other_feature);
    touch.is_turned = names.is_turned;
    touch.center = center, touch.place = center - radius * plane->normal;
    touch.origin = plane->origin, touch.normal = plane->normal, touch.radius = radius, touch.gap = gap;
    found.push_back(touch);
  };
  const auto look = [&](std::uint32_t part, std::uint32_t feature, const Vec3& center, double radius) {
    add(part, feature, center, radius, plane_of(other, center, middle));
  };
  for (const Solid* const solid : body.solids) {
    const Form& form = *solid->form;
    if (form.is_endless) continue;
    middle = solid->position + rotate(solid->turn, 0.5 * (form.box.low + form.box.high));
    const auto to_world = [&](const Vec3& local) { return solid->position + rotate(solid->turn, local); };
    if (form.mesh) {
      const std::vector<Vec3>& corners = corners_of(solid->form);
      const geometry::Bounds around = geometry::grown(bounds_of(other), within);
      for (std::uint32_t k = 0; k < corners.size(); ++k)
        if (const Vec3 corner = to_world(corners[k]); geometry::distance(around, corner) <= 0)
          look(solid->number, k, corner, 0);
      continue;
    }
    const std::optional<Plane> plane = plane_of(other, middle, middle);
    if (!plane) continue;
    const Quaternion back = conjugate(solid->turn);
    const Vec3 turn = rotate(back, spin);
    const auto visit_lowest_above = [&](const Plane& beneath, auto visit) {
      visit_features(form.shape, rotate(back, -1.0 * beneath.normal), turn, visit);
    };
    // The lowest point is sought once more above another plane than that beneath the middle: elsewhere the ball that touches a rim is
    // lower than the rim, and a ring bounced off the air beside a seam.
    const auto look_again = [&](const Feature& feature, Plane here) {
      constexpr int most = 4;
      for (int pass = 0; pass < most; ++pass) {
        std::optional<Feature> lowest;
        visit_lowest_above(here, [&](const Feature& again) {
          if (again.number == feature.number) lowest = again;
        });
        if (!lowest) return;
        const Vec3 center = to_world(lowest->center);
        const std::optional<Plane> there = plane_of(other, center, middle);
        if (!there || norm(there->normal - here.normal) <= same_normal)
          return add(solid->number, lowest->number, center, lowest->radius, there);
        if (pass + 1 == most) look(solid->number, lowest->number, center - lowest->radius * here.normal, 0);
        here = *there;
      }
    };
    visit_lowest_above(*plane, [&](const Feature& feature) {
      const Vec3 center = to_world(feature.center);
      const std::optional<Plane> here = plane_of(other, center, middle);
      if (here && feature.is_lowest && norm(here->normal - plane->normal) > same_normal)
        look_again(feature, *here);
      else
        add(solid->number, feature.number, center, feature.radius, here);
    });
  }
  for (const Line* const line : body.lines) {  // lines share points
    const auto is_known = [&](std::uint32_t particle) {
      return std::any_of(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(), [&](const Touch& touch) {
        return (names.is_turned ? touch.other_part : touch.part) == particle;
      });
    };
    if (!is_known(line->p)) look(line->p, 0, line->a, line->radius);
    if (!is_known(line->q)) look(line->q, 0, line->b, line->radius);
  }
}

}  // namespace iota::contact
