// SPDX-License-Identifier: Apache-2.0
#include "shape/shape.h"

#include "shape/shape_list.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iota::shape {

namespace {

/// Calls visit with each size of a shape.
template <class S, class Visit>
void for_each_size(Visit visit) {
  std::apply([&](const auto&... size) { (visit(size), ...); }, Traits<S>::sizes);
}

/// Calls visit with each number that a size consists of.
template <class Visit>
void for_each_number(double& value, Visit visit) {
  visit(value);
}
template <class Visit>
void for_each_number(Vec3& value, Visit visit) {
  visit(value.x), visit(value.y), visit(value.z);
}

template <class S>
void check_size(const Size<S, double>& size, double value) {
  if (size.range == Range::length_or_0 && value == 0) return;
  if (!(value >= shortest && value <= longest))
    refuse("the ", size.name, " of ", spoken<S>(), " must be ", size.range == Range::length_or_0 ? "0 or " : "",
           "between ", shortest, " and ", longest, " m, got ", value);
}
template <class S>
void check_size(const Size<S, Vec3>& size, const Vec3& value) {
  if (size.range == Range::direction) {
    if (!(is_finite(value) && norm(value) > 0))
      refuse("the ", size.name, " of ", spoken<S>(), " must be finite and not of zero length");
    return;
  }
  for (const double v : {value.x, value.y, value.z})
    if (!(v >= shortest && v <= longest))
      refuse("each number in the ", size.name, " of ", spoken<S>(), " must be between ", shortest, " and ", longest,
             " m, got ", v);
}

}  // namespace

Data to_data(const Shape& shape) {
  Data data;
  data.kind = static_cast<std::uint32_t>(shape.index());
  std::visit(
      [&]<class S>(S s) {
        std::size_t at = 0;
        for_each_size<S>(
            [&](const auto& size) { for_each_number(s.*size.member, [&](double v) { data.sizes.at(at++) = v; }); });
        if constexpr (requires { Traits<S>::key(s); }) data.key = Traits<S>::key(s);
      },
      shape);
  return data;
}

Shape from_data(const Data& data) {
  std::optional<Shape> shape;
  std::uint32_t kind = 0;
  for_each_shape([&]<class S>(S s) {
    if (kind++ != data.kind) return;
    std::size_t at = 0;
    for_each_size<S>(
        [&](const auto& size) { for_each_number(s.*size.member, [&](double& v) { v = data.sizes.at(at++); }); });
    shape = s;
  });
  if (!shape) refuse("there is no shape number ", data.kind, "; there are ", kind);
  return *shape;
}

std::string_view name(const Shape& shape) {
  return std::visit([]<class S>(const S&) { return Traits<S>::name; }, shape);
}

std::vector<std::string> size_names(const Shape& shape) {
  std::vector<std::string> names;
  std::visit(
      [&]<class S>(const S&) {
        for_each_size<S>([&]<class T>(const Size<S, T>& size) {
          if constexpr (std::is_same_v<T, Vec3>)
            for (const char* axis : {"_x", "_y", "_z"}) names.push_back(std::string(size.name) + axis);
          else
            names.emplace_back(size.name);
        });
      },
      shape);
  return names;
}

void check(const Shape& shape) {
  std::visit(
      []<class S>(const S& s) {
        for_each_size<S>([&](const auto& size) { check_size(size, s.*size.member); });
        Traits<S>::check(s);
      },
      shape);
}

bool is_solid(const Shape& shape) {
  if (const Mesh* const mesh = std::get_if<Mesh>(&shape)) return Traits<Mesh>::has_volume(*mesh);
  return std::visit([]<class S>(const S&) { return Massive<S>; }, shape);
}

bool is_within(const Shape& shape, const Vec3& p) {
  return std::visit([&]<class S>(const S& s) { return Traits<S>::is_within(s, p); }, shape);
}

Vec3 closest(const Shape& shape, const Vec3& p) {
  return std::visit([&]<class S>(const S& s) { return Traits<S>::closest(s, p); }, shape);
}

double distance(const Shape& shape, const Vec3& p) {
  const double apart = norm(p - closest(shape, p));
  return is_within(shape, p) ? -apart : apart;
}

Vec3 support(const Shape& shape, const Vec3& direction) {
  return std::visit([&]<class S>(const S& s) { return Traits<S>::support(s, direction); }, shape);
}

// Sphere tracing: a step of the distance to the surface is always safe (Hart 1996). A ray along a surface takes many
// steps.
std::optional<double> ray(const Shape& shape, const Vec3& from, const Vec3& unit, double farthest) {
  const double scale = std::visit([]<class S>(const S& s) { return Traits<S>::scale(s); }, shape);
  const double start = distance(shape, from), touching = std::min(1e-9 * start, 1e-6 * scale);
  double gone = 0, next = start;
  for (int step = 0; step < 10000 && gone <= farthest; ++step) {
    if (next <= std::max(touching, 1e-15 * (norm(from) + gone))) return gone;
    gone += next;
    next = distance(shape, from + gone * unit);
    if (!(next <= 1e9 * (start + scale))) break;
  }
  return std::nullopt;
}

Bounds bounds(const Shape& shape) {
  return {{support(shape, {-1, 0, 0}).x, support(shape, {0, -1, 0}).y, support(shape, {0, 0, -1}).z},
          {support(shape, {1, 0, 0}).x, support(shape, {0, 1, 0}).y, support(shape, {0, 0, 1}).z}};
}

Mesh triangulate(const Shape& shape, std::uint32_t fineness) {
  return std::visit(
      [&]<class S>(const S& s) -> Mesh {
        if constexpr (requires { Traits<S>::triangulate(s, fineness); })
          return Traits<S>::triangulate(s, fineness);
        else if constexpr (Massive<S>) {
          // Uniform directions: a spiral from pole to pole (Vogel 1979).
          std::vector<Vec3> points;
          for (std::uint32_t i = 0; i < fineness; ++i) {
            const double along = 1 - (2.0 * i + 1) / fineness, away = std::sqrt(1 - along * along);
            const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
            points.push_back(Traits<S>::support(s, {along, away * std::cos(angle), away * std::sin(angle)}));
          }
          return convex_hull(points);
        } else
          refuse(spoken<S>(), " has no end, so no triangles enclose it");
      },
      shape);
}

bool is_source(const Shape& shape) {
  return std::visit([]<class S>(const S&) { return Source<S>; }, shape);
}

Vec3 inside(const Shape& shape, const std::function<double(double, double)>& number) {
  return std::visit(
      [&]<class S>(const S& s) -> Vec3 {
        if constexpr (Source<S>) return Traits<S>::inside(s, number);
        refuse("particles cannot be born in ", spoken<S>());
      },
      shape);
}

}  // namespace iota::shape

namespace iota {

MassProperties mass_properties(const Shape& any) {
  shape::check(any);
  return std::visit(
      []<class S>(const S& s) -> MassProperties {
        if constexpr (shape::Massive<S>) return shape::Traits<S>::mass(s);
        shape::refuse(shape::spoken<S>(),
                      " has no volume, so no mass: only a static or scripted body can have it as its shape");
      },
      any);
}

}  // namespace iota
