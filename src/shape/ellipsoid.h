// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace iota::shape {

///          y
///       .--|--.      -
///     (    o----)--x   size.y
///       '-----'      -
///     |--size.x-|
/// With half axes a_k = size_k / 2 and the least of them a: phi = (sum (p_k / a_k)^2 - 1) a / 2.
template <>
struct Traits<Ellipsoid> {
  static constexpr std::string_view name = "ellipsoid", doc = "A ball that is stretched along x, y, z.";
  static constexpr std::tuple sizes{Size{"size", &Ellipsoid::size, Range::length, "its whole axes along x, y, z, m"}};
  static void check(const Ellipsoid&) {}
  static double scale(const Ellipsoid& e) { return 0.5 * std::min({e.size.x, e.size.y, e.size.z}); }

  static MassProperties mass(const Ellipsoid& e) {
    const auto& [x, y, z] = e.size;
    return {std::numbers::pi / 6 * x * y * z, {}, mean_squares(x * x / 20, y * y / 20, z * z / 20)};
  }
  static Level level(const Ellipsoid& e, const Vec3& p) {
    const double least = scale(e);
    const auto bend = [&](double size) { return least / (0.25 * size * size); };
    const Vec3 k{bend(e.size.x), bend(e.size.y), bend(e.size.z)}, gradient{k.x * p.x, k.y * p.y, k.z * p.z};
    return {(dot(gradient, p) - least) / 2, gradient, {{{k.x, 0, 0}, {0, k.y, 0}, {0, 0, k.z}}}};
  }
  static bool is_within(const Ellipsoid& e, const Vec3& p) {
    return norm({2 * p.x / e.size.x, 2 * p.y / e.size.y, 2 * p.z / e.size.z}) <= 1;
  }
  /// The foot of p is x_k = r_k p_k / (s + r_k), r_k = (a_k / a)^2, with s > -1 the root of a falling function, found by
  /// bisection (Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid, 2013).
  static Vec3 closest(const Ellipsoid& e, const Vec3& p) {
    const std::array<double, 3> at{p.x, p.y, p.z}, half{e.size.x / 2, e.size.y / 2, e.size.z / 2};
    std::size_t m = 0;  // the shortest axis; of equal ones that with most of p
    for (std::size_t k = 1; k < 3; ++k)
      if (half[k] < half[m] || (half[k] == half[m] && std::abs(at[k]) > std::abs(at[m]))) m = k;
    std::array<double, 3> r{}, z{}, foot{};
    for (std::size_t k = 0; k < 3; ++k) r[k] = half[k] / half[m] * (half[k] / half[m]), z[k] = at[k] / half[k];

    const auto squares = [&](double s) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        if (z[k] != 0) sum += r[k] * z[k] / (s + r[k]) * (r[k] * z[k] / (s + r[k]));
      return sum;
    };
    if (z[m] == 0 && squares(-1) < 1) {  // deep inside, on the plane of the longer axes: two feet, above and below
      double rest = 1;
      for (std::size_t k = 0; k < 3; ++k) {
        if (r[k] == 1) continue;
        foot[k] = r[k] * at[k] / (r[k] - 1);
        rest -= foot[k] / half[k] * (foot[k] / half[k]);
      }
      foot[m] = half[m] * std::sqrt(std::max(rest, 0.0));
      return {foot[0], foot[1], foot[2]};
    }
    double low = std::abs(z[m]) - 1, high = norm({r[0] * z[0], r[1] * z[1], r[2] * z[2]}) - 1;
    for (double s = (low + high) / 2; s > low && s < high; s = (low + high) / 2) (squares(s) > 1 ? low : high) = s;
    for (std::size_t k = 0; k < 3; ++k) foot[k] = r[k] * at[k] / (high + r[k]);
    return {foot[0], foot[1], foot[2]};
  }
  static Vec3 support(const Ellipsoid& e, const Vec3& d) {
    const Vec3 half = 0.5 * e.size, scaled{half.x * d.x, half.y * d.y, half.z * d.z};
    const double length = norm(scaled);
    return {half.x * scaled.x / length, half.y * scaled.y / length, half.z * scaled.z / length};
  }
  template <class Number>
  static Vec3 inside(const Ellipsoid& e, Number& number) {
    const Vec3 p = 0.5 * in_ball(number);
    return {e.size.x * p.x, e.size.y * p.y, e.size.z * p.z};
  }
};

}  // namespace iota::shape
