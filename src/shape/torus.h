// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iota::shape {

///          y
///     .----|----.   -
///    (  .--|--.  )  wire of radius `tube`
///    ( (   o---)-)--x      in the x-y plane; z looks out of the page
///    (  '-----'  )  center line: half circles of `radius` ...
///     '---------'
///       |-----|     ... pulled apart along x by `stretch`
/// All points within `tube` of the center line: with the distance d from it, phi = (d^2 - tube^2) / 2 tube.
template <>
struct Traits<Torus> {
  static constexpr std::string_view name = "torus",
                                    doc = "A ring in the x-y plane, or with `stretch` a link of a chain.";
  static constexpr std::tuple sizes{
      Size{"radius", &Torus::radius, Range::length, "of its center line, m"},
      Size{"tube", &Torus::tube, Range::length, "radius of its wire, m"},
      Size{"stretch", &Torus::stretch, Range::length_or_0, "straight length between its two half circles, along x, m"}};
  static void check(const Torus& t) {
    if (t.tube > t.radius)
      refuse("the tube of a torus (", t.tube, " m) must not be thicker than its radius (", t.radius,
             " m): it would cut itself");
  }
  static double scale(const Torus& t) { return t.tube; }

  static MassProperties mass(const Torus& t) {
    const double pi = std::numbers::pi, a2 = t.tube * t.tube, r = t.radius, s = t.stretch;
    const double bends = 2 * pi * pi * r * a2, straights = 2 * pi * a2 * s, volume = bends + straights;
    // Mean squares of a whole ring normal to its axis; of half a ring also the mean distance from its diameter.
    const double across = (r * r + 0.75 * a2) / 2, middle = (4 * r * r + a2) / (2 * pi * r);
    const double x = across + bends / volume * (s * s / 4 + s * middle) + straights / volume * (s * s / 12 - across);
    const double y = across + straights / volume * (r * r + a2 / 4 - across);
    return {volume, {}, mean_squares(x, y, a2 / 4)};
  }
  static Level level(const Torus& t, const Vec3& p) {
    const double u = beyond(t, p), rho = std::sqrt(u * u + p.y * p.y) + 1e-300;
    const Vec3 out{u / rho, p.y / rho, 0}, round{-out.y, out.x, 0};
    const double k = 1 / t.tube, across = rho - t.radius;
    Level l;
    l.value = k / 2 * (across * across + p.z * p.z - t.tube * t.tube);
    l.gradient = k * (across * out + Vec3{0, 0, p.z});
    l.hessian = k * Mat3::outer(out, out);
    if (u != 0 || t.stretch == 0) l.hessian += (k * across / rho) * Mat3::outer(round, round);
    l.hessian.m[2][2] += k;
    return l;
  }
  static bool is_within(const Torus& t, const Vec3& p) { return norm(p - nearest_on_line(t, p)) <= t.tube; }
  static Vec3 closest(const Torus& t, const Vec3& p) {
    const Vec3 on_line = nearest_on_line(t, p), d = p - on_line;
    const double distance = norm(d);
    return on_line + (distance > 0 ? (t.tube / distance) * d : Vec3{0, 0, t.tube});
  }
  static Vec3 support(const Torus& t, const Vec3& d) {
    const double in_plane = std::hypot(d.x, d.y);
    const Vec3 out = in_plane > 0 ? (t.radius / in_plane) * Vec3{d.x, d.y, 0} : Vec3{t.radius, 0, 0};
    return Vec3{d.x < 0 ? -t.stretch / 2 : t.stretch / 2, 0, 0} + out + (t.tube / norm(d)) * d;
  }
  template <class Number>
  static Vec3 inside(const Torus& t, Number& number) {
    const double bend = std::numbers::pi * t.radius, whole = 2 * (bend + t.stretch);
    for (;;) {
      const auto [v, w] = in_disc(number);
      const double s = number(0, whole), half = s < whole / 2 ? 1 : -1, along = half > 0 ? s : s - whole / 2;
      // In a bend there is more volume at the outer side of the wire.
      const double out = t.radius + t.tube * v, room = along < bend ? out : t.radius;
      if (number(0, t.radius + t.tube) > room) continue;
      if (along >= bend) return {along - bend - t.stretch / 2, half * out, t.tube * w};
      const double angle = along / t.radius - std::numbers::pi / 2;
      return {half * (t.stretch / 2 + out * std::cos(angle)), out * std::sin(angle), t.tube * w};
    }
  }
  /// It is not convex, so its triangles follow the wire.
  static Mesh triangulate(const Torus& t, std::uint32_t columns) {
    Mesh mesh;
    const std::uint32_t rows = 4 * columns;
    for (std::uint32_t i = 0; i < rows; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.5) / rows;
      const Vec3 out{std::cos(angle), std::sin(angle), 0}, shift{out.x < 0 ? -t.stretch / 2 : t.stretch / 2, 0, 0};
      for (std::uint32_t j = 0; j < columns; ++j) {
        const double around = 2 * std::numbers::pi * j / columns;
        mesh.vertices.push_back(shift + (t.radius + t.tube * std::cos(around)) * out +
                                Vec3{0, 0, t.tube * std::sin(around)});
        const std::uint32_t next_i = (i + 1) % rows, next_j = (j + 1) % columns;
        const std::uint32_t a = i * columns + j, b = next_i * columns + j, c = next_i * columns + next_j,
                            d = i * columns + next_j;
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
    return mesh;
  }

 private:
  /// Distance along x beyond the straight wires.
  static double beyond(const Torus& t, const Vec3& p) { return p.x - std::clamp(p.x, -t.stretch / 2, t.stretch / 2); }
  static Vec3 nearest_on_line(const Torus& t, const Vec3& p) {
    const double u = beyond(t, p), rho = std::hypot(u, p.y);
    const Vec3 out = rho > 0 ? Vec3{u / rho, p.y / rho, 0} : Vec3{0, 1, 0};
    return Vec3{p.x - u, 0, 0} + t.radius * out;
  }
};

}  // namespace iota::shape
