// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <limits>

namespace iota::shape {

///         ^ normal
///         |
///  -------o-------   all points p with normal . p <= 0: the ground, a wall
///  /////////////////
/// phi = normal . p / |normal|. It is infinite, so without a volume.
template <>
struct Traits<HalfSpace> {
  static constexpr std::string_view name = "half_space",
                                    doc = "All on one side of a plane through the origin: the ground, a wall.";
  static constexpr std::tuple sizes{
      Size{"normal", &HalfSpace::normal, Range::direction, "points out of it; its length does not matter"}};
  static void check(const HalfSpace&) {}
  static double scale(const HalfSpace&) { return 1; }

  static Level level(const HalfSpace& h, const Vec3& p) {
    const Vec3 n = unit(h.normal);
    return {dot(n, p), n, {}};
  }
  static bool is_within(const HalfSpace& h, const Vec3& p) { return dot(h.normal, p) <= 0; }
  static Vec3 closest(const HalfSpace& h, const Vec3& p) {
    const Vec3 n = unit(h.normal);
    return p - dot(n, p) * n;
  }
  static Vec3 support(const HalfSpace& h, const Vec3& d) {
    if (norm(cross(unit(h.normal), unit(d))) < 1e-12 && dot(h.normal, d) > 0) return {};
    const auto far = [](double v) { return v == 0 ? 0 : v * std::numeric_limits<double>::infinity(); };
    return {far(d.x), far(d.y), far(d.z)};
  }

 private:
  static Vec3 unit(const Vec3& v) { return (1 / norm(v)) * v; }
};

}  // namespace iota::shape
