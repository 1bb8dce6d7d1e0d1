// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/meridian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace iota::shape {

///           y
///      .----|----.  -
///      |    o----|--x--   size.y, with its edges rounded by arcs of `rounding`, its corners by spheres
///      '---------'  -
///      |-size.x--|
/// All points within `rounding` of a smaller core: with q_k = |p_k| - (size_k / 2 - rounding),
/// phi = |max(q, 0)| + min(max_k q_k, 0) - rounding, outside the core the distance.
template <>
struct Traits<Box> {
  static constexpr std::string_view name = "box", doc = "A box with edges along x, y, z.";
  static constexpr std::tuple sizes{
      Size{"size", &Box::size, Range::length, "its edges along x, y, z, m"},
      Size{"rounding", &Box::rounding, Range::length_or_0, "radius of its edges, m: at most half the least edge"}};
  static void check(const Box& b) {
    if (b.rounding > scale(b))
      refuse("the rounding of a box (", b.rounding, " m) must not be above half its least edge (", scale(b), " m)");
  }
  static double scale(const Box& b) { return 0.5 * std::min({b.size.x, b.size.y, b.size.z}); }
  static double skin(const Box& b) { return b.rounding < 0.5 * edge_skin * scale(b) ? edge_skin * scale(b) : 0; }
  static double skin_level(const Box& b) { return skin(b); }

  static MassProperties mass(const Box& b) {
    const auto& [x, y, z] = b.size;
    if (b.rounding == 0) return {x * y * z, {}, mean_squares(x * x / 12, y * y / 12, z * z / 12)};
    // The core, two slabs on each pair of faces, quarter cylinders along the edges, eighths of a ball at the corners.
    const double r = b.rounding, pi = std::numbers::pi;
    const std::array<double, 3> c{x / 2 - r, y / 2 - r, z / 2 - r};
    double volume = 0;
    std::array<double, 3> sum{};
    const auto add = [&](double part, const std::array<double, 3>& squares) {
      volume += part;
      for (std::size_t k = 0; k < 3; ++k) sum[k] += part * squares[k];
    };
    const auto within = [&](std::size_t k) { return c[k] * c[k] / 3; };
    add(8 * c[0] * c[1] * c[2], {within(0), within(1), within(2)});
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      std::array<double, 3> slab{within(0), within(1), within(2)}, edge = slab;
      slab[k] = c[k] * c[k] + c[k] * r + r * r / 3;
      add(8 * r * c[i] * c[j], slab);
      for (const std::size_t across : {i, j})
        edge[across] = c[across] * c[across] + c[across] * r * 8 / (3 * pi) + r * r / 4;
      add(2 * pi * r * r * c[k], edge);
    }
    const auto corner = [&](std::size_t k) { return c[k] * c[k] + 0.75 * c[k] * r + r * r / 5; };
    add(4 * pi / 3 * r * r * r, {corner(0), corner(1), corner(2)});
    return {volume, {}, mean_squares(sum[0] / volume, sum[1] / volume, sum[2] / volume)};
  }

  static Level level(const Box& b, const Vec3& p) {
    const From from(b, p);
    Level l;
    double gradient[3] = {};
    if (from.length > 0) {
      const double bend = 1 / std::max(from.length, edge_bluntness * scale(b));
      for (int i = 0; i < 3; ++i) {
        if (!(from.q[i] > 0)) continue;
        gradient[i] = from.sign[i] * from.q[i] / from.length;
        for (int j = 0; j < 3; ++j)
          if (from.q[j] > 0)
            l.hessian.m[i][j] = bend * ((i == j ? 1 : 0) - gradient[i] * from.sign[j] * from.q[j] / from.length);
      }
      l.value = from.length - b.rounding;
    } else {
      gradient[from.largest] = from.sign[from.largest];
      l.value = from.q[from.largest] - b.rounding;
    }
    l.gradient = {gradient[0], gradient[1], gradient[2]};
    return l;
  }
  static bool is_within(const Box& b, const Vec3& p) {
    const From from(b, p);
    return from.length <= b.rounding;
  }
  static Vec3 closest(const Box& b, const Vec3& p) {
    const From from(b, p);
    double at[3] = {p.x, p.y, p.z};
    if (from.length > 0)  // from the core outwards
      for (int k = 0; k < 3; ++k) {
        if (from.q[k] > 0) at[k] = from.sign[k] * (from.core[k] + b.rounding * from.q[k] / from.length);
      }
    else
      at[from.largest] = from.sign[from.largest] * (from.core[from.largest] + b.rounding);
    return {at[0], at[1], at[2]};
  }
  static Vec3 support(const Box& b, const Vec3& d) {
    const From from(b, d);
    return Vec3{from.sign[0] * from.core[0], from.sign[1] * from.core[1], from.sign[2] * from.core[2]} +
           (b.rounding / norm(d)) * d;
  }
  template <class Number>
  static Vec3 inside(const Box& b, Number& number) {
    for (;;) {
      const double x = number(-0.5, 0.5), y = number(-0.5, 0.5), z = number(-0.5, 0.5);
      const Vec3 p{b.size.x * x, b.size.y * y, b.size.z * z};
      if (b.rounding == 0 || is_within(b, p)) return p;
    }
  }

 private:
  /// A point relative to the core.
  struct From {
    double core[3], q[3], sign[3], length = 0;  // length: distance from the core
    int largest = 0;                            // the nearest face of an inner point
    From(const Box& b, const Vec3& p) {
      const double at[3] = {p.x, p.y, p.z}, size[3] = {b.size.x, b.size.y, b.size.z};
      for (int k = 0; k < 3; ++k) {
        core[k] = size[k] / 2 - b.rounding;
        sign[k] = at[k] < 0 ? -1 : 1;
        q[k] = std::abs(at[k]) - core[k];
        if (q[k] > q[largest]) largest = k;
        if (q[k] > 0) length += q[k] * q[k];
      }
      length = std::sqrt(length);
    }
  };
};

}  // namespace iota::shape
