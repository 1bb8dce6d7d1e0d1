// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/level.h"

#include <iota/shapes.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>

/// Shapes: one header each, listed in shape_list.h. All have one frame convention: the origin is at the center, the
/// long axis is x, sizes are full (except radii). Drawing, mass and constraints use the same shape.
namespace iota::shape {

/// The range of a size.
enum class Range {
  length,       ///< between shortest and longest
  length_or_0,  ///< 0, which is the default, or a length
  direction,    ///< any vector except zero; has a default
};
inline constexpr double shortest = 1e-9, longest = 1e9;  ///< m

/// A size of a shape: a number, or three.
template <class S, class T>
struct Size {
  std::string_view name;
  T S::* member;
  Range range;
  std::string_view doc;
};
template <class S, class T>
Size(std::string_view, T S::*, Range, std::string_view) -> Size<S, T>;

/// The properties of a shape S. Its header specializes this template. `Known` lists the required functions; optional
/// ones are below.
template <class S>
struct Traits;

template <class S>
concept Known = requires(const S& s, const Vec3& p) {
  { Traits<S>::name } -> std::convertible_to<std::string_view>;
  { Traits<S>::doc } -> std::convertible_to<std::string_view>;
  Traits<S>::sizes;                                             ///< tuple of Size: those that are plain numbers
  { Traits<S>::check(s) };                                      ///< throws if sizes, each valid, are inconsistent
  { Traits<S>::closest(s, p) } -> std::same_as<Vec3>;           ///< the nearest point of the surface
  { Traits<S>::is_within(s, p) } -> std::convertible_to<bool>;  ///< inside, or on the surface
  { Traits<S>::support(s, p) } -> std::same_as<Vec3>;           ///< a farthest point along p, which is not zero
  { Traits<S>::scale(s) } -> std::convertible_to<double>;       ///< a length to measure violations by, m
};

/// It has a volume and so a mass: mass(s).
template <class S>
concept Massive = requires(const S& s) {
  { Traits<S>::mass(s) } -> std::same_as<MassProperties>;
};
/// A constraint can hold a point on it: level(s, p) is zero on the surface, negative inside, and near the surface about
/// the distance. It is quadratic if possible, which the energy-keeping scheme follows exactly.
template <class S>
concept Holding = requires(const S& s, const Vec3& p) {
  { Traits<S>::level(s, p) } -> std::same_as<Level>;
};
/// Its surface has sharp edges without normals; surfaces of constant level outside are rounded. skin(s): distance of
/// one of them, m, 0 if the sizes leave no sharp edge; skin_level(s): phi there.
template <class S>
concept Edged = requires(const S& s) {
  { Traits<S>::skin(s) } -> std::convertible_to<double>;
  { Traits<S>::skin_level(s) } -> std::convertible_to<double>;
};
/// Particles can be born in it, uniformly: inside(s, number), where number(low, high) draws a number.
template <class S>
concept Source = requires(const S& s, double (*number)(double, double)) {
  { Traits<S>::inside(s, number) } -> std::same_as<Vec3>;
};

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw std::invalid_argument(text.str());
}

/// "a box", "an octahedron", "a half-space".
template <class S>
std::string spoken() {
  std::string text(Traits<S>::name);
  std::replace(text.begin(), text.end(), '_', '-');
  return (std::string_view("aeiou").find(text.front()) != std::string_view::npos ? "an " : "a ") + text;
}

/// The diagonal of MassProperties::mean_squares.
inline Matrix3 mean_squares(double x, double y, double z) { return {Vec3{x, 0, 0}, Vec3{0, y, 0}, Vec3{0, 0, z}}; }

/// A point of the unit disc, of the unit ball: by rejection.
template <class Number>
std::array<double, 2> in_disc(Number& number) {
  for (;;) {
    const double u = number(-1, 1), v = number(-1, 1);
    if (u * u + v * v <= 1) return {u, v};
  }
}
template <class Number>
Vec3 in_ball(Number& number) {
  for (;;) {
    const double x = number(-1, 1), y = number(-1, 1), z = number(-1, 1);
    if (x * x + y * y + z * z <= 1) return {x, y, z};
  }
}

}  // namespace iota::shape
