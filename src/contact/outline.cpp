// SPDX-License-Identifier: Apache-2.0
#include "contact/outline.h"

#include "geometry/overlap.h"
#include "math/mat3.h"
#include "shape/shape_list.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iota::contact {

using geometry::Bounds;

namespace {

constexpr double close = 1e-6;  ///< of a line's radius: a ray that comes so near has met it
constexpr int most_marches = 1000;
constexpr std::uint32_t fineness = 24;  ///< of the triangles of a torus: 0.9 % of its wire, 0.03 % of its radius inside

double reach_of(const Bounds& box) {
  const auto most = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
  return norm({most(box.low.x, box.high.x), most(box.low.y, box.high.y), most(box.low.z, box.high.z)});
}

/// Sphere tracing, see shape::ray, from the plane before the line to that behind it.
std::optional<double> meet(const Line& line, const Vec3& from, const Vec3& unit, double farthest) {
  const double first = dot(line.a - from, unit), last = dot(line.b - from, unit);
  const double end = std::min(farthest, std::max(first, last) + line.radius);
  double gone = std::max(std::min(first, last) - line.radius, 0.0);
  for (int march = 0; march < most_marches && gone <= end; ++march) {
    const Vec3 place = from + gone * unit;
    const double apart = norm(place - nearest_of_middle(line, place)) - line.radius;
    if (apart <= close * line.radius) return gone;
    gone += apart;
  }
  return std::nullopt;
}

Vec3 support_of_probe(const Solid& probe, const Vec3& direction) {
  return probe.position + rotate(probe.turn, support(*probe.form, rotate(conjugate(probe.turn), direction)));
}

bool is_overlapped(const Line& line, const Solid& probe) {
  const auto support = [&](const Vec3& d) {
    return (dot(line.a, d) > dot(line.b, d) ? line.a : line.b) + line.radius / norm(d) * d;
  };
  return geometry::overlap(support, [&](const Vec3& d) { return support_of_probe(probe, d); });
}

bool is_overlapped(const Solid& solid, const Solid& probe) {
  const Form& form = *solid.form;
  const Quaternion back = conjugate(solid.turn);
  const Vec3 middle = rotate(back, probe.position - solid.position);
  const auto local = [&](const Vec3& direction) {
    return rotate(back, support_of_probe(probe, rotate(solid.turn, direction)) - solid.position);
  };
  if (is_within(form, middle)) return true;
  if (const geometry::TriangleTree* const tree = form.mesh ? form.mesh.get() : form.surface.get()) {
    bool is_met = false;
    tree->near(middle, reach_of(probe.form->box), [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      const auto triangle = [&](const Vec3& d) {
        const Vec3 ahead = dot(a, d) > dot(b, d) ? a : b;
        return dot(ahead, d) > dot(c, d) ? ahead : c;
      };
      is_met = is_met || geometry::overlap(triangle, local);
    });
    return is_met;
  }
  // An endless convex one: the probe's point that is farthest on the way to it is in it, or none is.
  if (form.is_endless) return shape::is_within(form.shape, local(shape::closest(form.shape, middle) - middle));
  return geometry::overlap([&](const Vec3& d) { return shape::support(form.shape, d); }, local);
}

}  // namespace

Vec3 closest(const Form& form, const Vec3& place) {
  return form.mesh ? form.mesh->closest(place) : shape::closest(form.shape, place);
}

bool is_within(const Form& form, const Vec3& place) {
  return form.mesh ? form.mesh->is_within(place) : shape::is_within(form.shape, place);
}

Vec3 support(const Form& form, const Vec3& direction) {
  if (!form.mesh) return shape::support(form.shape, direction);
  return std::ranges::max(form.mesh->vertices(), {}, [&](const Vec3& corner) { return dot(corner, direction); });
}

Vec3 outwards(const Solid& half_space) {
  return rotate(half_space.turn, unit_or(std::get<HalfSpace>(half_space.form->shape).normal, {}));
}

Vec3 nearest_of_middle(const Line& line, const Vec3& place) {
  const Vec3 along = line.b - line.a;
  const double squared = dot(along, along);
  return squared > 0 ? line.a + std::clamp(dot(place - line.a, along) / squared, 0.0, 1.0) * along : line.a;
}

bool is_convex(const Shape& shape) {
  // Shapes that are not have triangles of their own, as a hull would close their holes.
  return std::visit([]<class S>(const S& s) { return !requires { shape::Traits<S>::triangulate(s, 0u); }; }, shape);
}

std::shared_ptr<const Form> make_form(Shape shape) {
  auto form = std::make_shared<Form>();
  if (auto* const mesh = std::get_if<Mesh>(&shape)) {
    form->mesh = std::make_unique<geometry::TriangleTree>(std::move(*mesh));
    form->box = form->mesh->box();
    form->shape = Mesh{};
    return form;
  }
  if (!is_convex(shape)) form->surface = std::make_unique<geometry::TriangleTree>(shape::triangulate(shape, fineness));
  form->is_endless = !shape::is_solid(shape);
  if (!form->is_endless) {
    const shape::Bounds box = shape::bounds(shape);
    form->box = {box.low, box.high};
  }
  form->shape = std::move(shape);
  return form;
}

std::shared_ptr<const Form> make_open_form(Mesh mesh) {
  auto form = std::make_shared<Form>();
  form->mesh = std::make_unique<geometry::TriangleTree>(std::move(mesh), false);
  form->box = form->mesh->box();
  form->shape = Mesh{};
  return form;
}

Near near(const Outline& outline, const Vec3& place) {
  Near best;
  for (const Solid& solid : outline.solids) {
    const Form& form = *solid.form;
    const Vec3 local = to_local(solid, place);
    const Vec3 point = closest(form, local);
    const double apart = is_within(form, local) ? -norm(local - point) : norm(local - point);
    if (apart < best.distance) best = {apart, to_world(solid, point)};
  }
  for (const Line& line : outline.lines) {
    const Vec3 middle = nearest_of_middle(line, place), away = place - middle;
    const double length = norm(away);
    if (length - line.radius >= best.distance) continue;
    best = {length - line.radius, middle + line.radius * (length > 0 ? (1 / length) * away : Vec3{0, 1, 0})};
  }
  return best;
}

std::optional<double> meet(const Outline& outline, const Vec3& from, const Vec3& unit, double farthest) {
  std::optional<double> first;
  const auto found = [&](std::optional<double> distance) {
    if (distance && *distance <= farthest) first = distance, farthest = *distance;
  };
  for (const Solid& solid : outline.solids) {
    const Form& form = *solid.form;
    const Quaternion back = conjugate(solid.turn);
    const Vec3 local = rotate(back, from - solid.position), direction = rotate(back, unit);
    found(form.mesh ? form.mesh->ray(local, direction, farthest) : shape::ray(form.shape, local, direction, farthest));
  }
  for (const Line& line : outline.lines) found(meet(line, from, unit, farthest));
  return first;
}

bool is_overlapped(const Outline& outline, const Solid& probe) {
  const auto is_met = [&](const auto& part) { return is_overlapped(part, probe); };
  return std::ranges::any_of(outline.solids, is_met) || std::ranges::any_of(outline.lines, is_met);
}

double reach(const Outline& outline, const Vec3& place) {
  constexpr double digits = 1024;
  double farthest = 0;
  for (const Solid& solid : outline.solids)
    farthest = std::max(farthest, norm(solid.position - place) + reach_of(solid.form->box));
  for (const Line& line : outline.lines)
    farthest = std::max({farthest, norm(line.a - place) + line.radius, norm(line.b - place) + line.radius});
  int exponent = 0;
  const double part = std::frexp(farthest, &exponent);
  return std::ldexp(std::ceil(part * digits) / digits, exponent);
}

/// The box around a turned box: its half edges are sums of the absolute parts of the turned ones.
Bounds bounds(const Solid& solid, const Vec3& anchor) {
  const auto [x, y, z, w] = solid.turn;
  const Bounds& own = solid.form->box;
  const Vec3 middle = solid.position - anchor + rotate(solid.turn, 0.5 * (own.low + own.high)),
             half = 0.5 * (own.high - own.low);
  const double xy = 2 * x * y, xz = 2 * x * z, yz = 2 * y * z, xw = 2 * x * w, yw = 2 * y * w, zw = 2 * z * w;
  const Vec3 reach{
      std::abs(1 - 2 * (y * y + z * z)) * half.x + std::abs(xy - zw) * half.y + std::abs(xz + yw) * half.z,
      std::abs(xy + zw) * half.x + std::abs(1 - 2 * (x * x + z * z)) * half.y + std::abs(yz - xw) * half.z,
      std::abs(xz - yw) * half.x + std::abs(yz + xw) * half.y + std::abs(1 - 2 * (x * x + y * y)) * half.z};
  return {middle - reach, middle + reach};
}

Bounds bounds(const Line& line, const Vec3& anchor) {
  const Vec3 a = line.a - anchor, b = line.b - anchor;
  return geometry::grown(geometry::around(a, b), line.radius);
}

Bounds bounds(const Outline& outline) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Bounds all{{far, far, far}, {-far, -far, -far}};
  for (const Solid& solid : outline.solids) {
    if (solid.form->is_endless) return {{-far, -far, -far}, {far, far, far}};
    all = joined(all, bounds(solid, {}));
  }
  for (const Line& line : outline.lines) all = joined(all, bounds(line, {}));
  return all;
}

}  // namespace iota::contact
