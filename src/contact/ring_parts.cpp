// SPDX-License-Identifier: Apache-2.0
#include "contact/ring_parts.h"

#include "contact/manifold.h"
#include "contact/minima.h"
#include "contact/ring_pairs.h"
#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

namespace iota::contact {

namespace {

constexpr double on_border = 1e-7;  ///< of the size: a place is on a face, an edge or a rim

/// The surface near one of its places: a plane, or what is within a radius of a straight or bent line, or of a point.
struct Nearby {
  enum class Kind : std::uint8_t { plane, line, point } kind;
  Vec3 place;  ///< of the line or the point, or on the plane
  double radius = 0;
  Vec3 along, bend;  ///< of the line: its tangent, and towards its center of curvature, 1/m
};
using Kind = Nearby::Kind;

double from_axis(const Vec3& p) { return std::hypot(p.y, p.z); }
Vec3 outwards(const Vec3& p) { return (1 / from_axis(p)) * Vec3{0, p.y, p.z}; }

/// A circle around the x axis.
Nearby rim(double x, double circle, const Vec3& p, double radius) {
  const Vec3 out = outwards(p);
  return {Kind::line, Vec3{x, 0, 0} + circle * out, radius, cross({1, 0, 0}, out), (-1 / circle) * out};
}

Nearby nearby(const Box& box, const Vec3& p, const Vec3& on_surface) {
  const Vec3 half = 0.5 * box.size - Vec3{box.rounding, box.rounding, box.rounding};
  const Vec3 core{std::clamp(p.x, -half.x, half.x), std::clamp(p.y, -half.y, half.y), std::clamp(p.z, -half.z, half.z)};
  const bool beyond[] = {core.x != p.x, core.y != p.y, core.z != p.z};
  const auto count = std::count(beyond, beyond + 3, true);
  if (count == 1) return {Kind::plane, on_surface};
  if (count == 3) return {Kind::point, core, box.rounding};
  return {Kind::line, core, box.rounding, {beyond[0] ? 0.0 : 1.0, beyond[1] ? 0.0 : 1.0, beyond[2] ? 0.0 : 1.0}};
}

Nearby nearby(const Cylinder& c, const Vec3& p, const Vec3& on_surface) {
  const double half = 0.5 * c.length - c.rounding, circle = c.radius - c.rounding;
  if (std::abs(p.x) <= half) return {Kind::line, {p.x, 0, 0}, c.radius, {1, 0, 0}};
  if (from_axis(p) <= circle) return {Kind::plane, on_surface};
  const double end = std::copysign(half, p.x);
  return circle > 0 ? rim(end, circle, p, c.rounding) : Nearby{Kind::point, {end, 0, 0}, c.rounding};
}

Nearby nearby(const Cone& c, const Vec3& on_surface, const Vec3& normal) {
  const double base = -0.5 * c.length, size = c.radius + c.length, slope = std::hypot(c.radius, c.length);
  const double far = from_axis(on_surface);
  if (on_surface.x > -base - on_border * size) return {Kind::point, {-base, 0, 0}};
  if (on_surface.x < base + on_border * size)
    return far < c.radius - on_border * size ? Nearby{Kind::plane, on_surface} : rim(base, c.radius, on_surface, 0);
  const double radius = far * slope / c.length;  // along the normal to the axis
  const Vec3 along = (1 / slope) * (Vec3{c.length, 0, 0} - c.radius * outwards(on_surface));
  return {Kind::line, on_surface - radius * normal, radius, along};
}

/// A ball as round as the surface is along the way across the ring.
Nearby nearby(const Ellipsoid& e, const Vec3& on_surface, const Vec3& normal, const Vec3& across) {
  const auto over_squares = [&](const Vec3& v) {
    return Vec3{v.x / (e.size.x * e.size.x), v.y / (e.size.y * e.size.y), v.z / (e.size.z * e.size.z)};
  };
  const double radius = norm(over_squares(on_surface)) / dot(across, over_squares(across));
  return {Kind::point, on_surface - radius * normal, radius};
}

/// A mesh has as many faces at a place as are flush with it.
Nearby nearby(const ConvexPart& part, const Vec3& on_surface) {
  Vec3 normals[2];
  int count = 0;
  for (std::size_t f = 0; f < part.core->faces.size(); ++f) {
    const Vec3& corner = part.corners[part.core->sides[part.core->faces[f].begin].corner];
    if (!(dot(part.normals[f], on_surface - corner) > -on_border * part.size)) continue;
    if (count == 2 && std::abs(dot(part.normals[f], cross(normals[0], normals[1]))) > on_border)
      return {Kind::point, on_surface};
    if (count < 2) normals[count++] = part.normals[f];
  }
  if (count < 2) return {Kind::plane, on_surface};
  return {Kind::line, on_surface, 0, unit_or(cross(normals[0], normals[1]), {})};
}

}  // namespace

void add_touches_of_ring(const Solid& torus, const Solid& solid, const ConvexPart& part, bool is_ring_second,
                         const Vec3& anchor, double within, std::vector<Touch>& found) {
  constexpr double lying = 1e-3;   // of the tube
  constexpr double rolling = 0.5;  // sine of a ring with a face, above which it rolls on the face
  constexpr std::uint32_t first_feature = 0x400, first_rolling = 0x80, other_half = 0x40;
  constexpr std::uint32_t first_around = 0x500;
  constexpr std::uint32_t places_around = 6;
  const Form& form = *solid.form;
  const Ring ring = make_ring(torus, anchor);
  const Vec3 position = solid.position - anchor;
  const Quaternion back = conjugate(solid.turn);
  const auto to_solid = [&](const Vec3& place) { return rotate(back, place - position); };
  const auto to_anchor = [&](const Vec3& place) { return position + rotate(solid.turn, place); };
  Ring seen = ring;  // from the solid
  seen.middle = to_solid(ring.middle);
  for (Vec3& axis : seen.axes) axis = rotate(back, axis);
  const auto distance = [&](double share) {
    const Vec3 p = seen.point(share);
    const double apart = norm(p - closest(form, p));
    return is_within(form, p) ? -apart : apart;
  };
  Minimum minima[4];
  const int count = find_minima(
      distance,
      {.samples = 64, .is_closed = true, .limit = within + ring.tube, .level = lying * ring.tube, .steps = 28}, minima);
  const auto nearby_of = [&](const Vec3& p, const Vec3& on_surface, const Vec3& normal, const Vec3& across) {
    if (const auto* const box = std::get_if<Box>(&form.shape)) return nearby(*box, p, on_surface);
    if (const auto* const c = std::get_if<Cylinder>(&form.shape)) return nearby(*c, p, on_surface);
    if (const auto* const c = std::get_if<Cone>(&form.shape)) return nearby(*c, on_surface, normal);
    if (const auto* const e = std::get_if<Ellipsoid>(&form.shape)) return nearby(*e, on_surface, normal, across);
    Nearby found_there = nearby(part, to_anchor(on_surface));
    found_there.place = to_solid(found_there.place), found_there.along = rotate(back, found_there.along);
    return found_there;
  };
  const auto add = [&](const Nearby& there, const Vec3& local, const Vec3& normal, std::uint32_t feature) {
    const Vec3 p = to_anchor(local), away = rotate(solid.turn, normal), tangent = ring.tangent(p), bend = ring.bend(p);
    ConvexPart wire, other;
    wire.radius = ring.tube, other.radius = there.radius;
    TouchWriter writer(is_ring_second ? other : wire, is_ring_second ? wire : other, anchor, within, found);
    const FeatureName of_ring{torus.number, feature}, of_solid{solid.number, feature};
    if (there.kind == Kind::plane) {
      // A ring that bends away from the face rolls on the ball that touches it all around.
      const double inwards = dot(bend, away);
      const double reach = inwards > rolling * norm(bend) ? 1 / inwards : 0;
      return writer.add_face(is_ring_second, p + reach * away, ring.tube + reach, away,
                             dot(normal, local - there.place) + reach, of_ring, of_solid);
    }
    const Vec3 place = to_anchor(there.place), along = rotate(solid.turn, there.along),
               bent = rotate(solid.turn, there.bend);
    const FeatureName &of_first = is_ring_second ? of_solid : of_ring, &of_second = is_ring_second ? of_ring : of_solid;
    const Vec3 &on_first = is_ring_second ? place : p, &on_second = is_ring_second ? p : place;
    if (there.kind == Kind::point)
      writer.add_round(on_first, on_second, tangent, of_first, of_second);
    else if (is_ring_second)
      writer.add_wires(on_first, on_second, along, bent, tangent, bend, of_first, of_second);
    else
      writer.add_wires(on_first, on_second, tangent, bend, along, bent, of_first, of_second);
  };
  const auto add_on_plane = [&](const Vec3& normal, const Vec3& local, std::uint32_t feature) {
    const Vec3 on_surface = closest(form, local), own = unit_or(local - on_surface, {});
    if (dot(own, normal) > 1 - on_border && !is_within(form, local))
      add({Kind::plane, on_surface}, local, own, feature);
  };
  // A ring that lies on a face, or nearly, touches it with places all around, but for one that is there already.
  const auto add_around = [&](const Vec3& normal, std::optional<double> known) {
    for (std::uint32_t k = 0; k < places_around; ++k) {
      const double share = static_cast<double>(k) / places_around, off = std::abs(share - known.value_or(share + 0.5));
      if (std::min(off, 1 - off) > 0.25 / places_around) add_on_plane(normal, seen.point(share), first_around + k);
    }
  };
  // The lowest point of its circle above a face, to the last digit; of a link, one of each half circle.
  const auto add_lowest = [&](const Vec3& normal, std::uint32_t feature) {
    const Vec3 level = unit_or(normal - dot(normal, seen.axes[2]) * seen.axes[2], {});
    const auto lowest = [&](double side) {
      const bool is_on_arc = side * dot(level, seen.axes[0]) <= 0;
      const Vec3 out = is_on_arc ? -level : std::copysign(1.0, -dot(level, seen.axes[1])) * seen.axes[1];
      return seen.middle + (side * seen.half_stretch) * seen.axes[0] + seen.radius * out;
    };
    if (seen.half_stretch == 0) return add_on_plane(normal, lowest(0), feature);
    for (const double side : {1.0, -1.0}) add_on_plane(normal, lowest(side), feature + (side < 0 ? other_half : 0));
  };
  if (count == 0) {
    const Vec3 local = seen.point(0);
    return is_within(form, local) ? void() : add_around(unit_or(local - closest(form, local), {}), {});
  }
  std::uint32_t taken[4] = {};
  bool lies = false;
  for (int k = 0; k < count; ++k) {
    const Vec3 local = seen.point(minima[k].share), on_surface = closest(form, local);
    if (!(norm(local - on_surface) > on_border * part.size)) continue;
    const bool is_inside = is_within(form, local);
    const Vec3 normal = unit_or(is_inside ? on_surface - local : local - on_surface, {});
    const Vec3 across = unit_or(cross(normal, seen.tangent(local)), any_perpendicular(normal));
    const Nearby there = is_inside ? Nearby{Kind::plane, on_surface} : nearby_of(local, on_surface, normal, across);
    const Vec3 bend = seen.bend(local);
    const double inwards = dot(bend, normal), flat = dot(normal, seen.axes[2]);
    const bool is_plane = there.kind == Kind::plane, rolls = is_plane && flat * flat < 1 - rolling * rolling;
    // A ring that rolls keeps its touch all around, others have one in each quarter.
    taken[k] = first_feature + (rolls ? first_rolling : seen.quarter(local));
    while (std::find(taken, taken + k, taken[k]) != taken + k) taken[k] += 4;
    const std::size_t before = found.size();
    if (is_plane && !is_inside && (inwards > 0 || seen.half_stretch > 0)) add_lowest(normal, taken[k]);
    if (found.size() == before) add(there, local, normal, taken[k]);
    if (!is_plane || rolls || lies) continue;
    lies = true;
    add_around(normal, minima[k].share);
  }
}

}  // namespace iota::contact
