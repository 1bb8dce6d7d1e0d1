// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/wider.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

/// Elementary functions of +, -, *, / and bit operations only: the same bits from every compiler and at every
/// optimization level (the functions of libm differ), and without branches, so that loops over them are vectorized.
/// Relative errors stay below 4e-16, unless said otherwise.
namespace iota::expression {

namespace detail {

inline constexpr double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;
inline constexpr double to_integer = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer

/// 2^n for n = 0x1.8p52-shifted integer bits, |n| <= 1022. They are modulo 2^64: those of a NaN are any number.
IOTA_ALWAYS_INLINE double power_of_two(std::uint64_t n) { return std::bit_cast<double>((n + 1023) << 52); }

struct Reduced {
  double p;         ///< exp(r) - 1
  std::uint64_t n;  ///< exp(x) = 2^n (1 + p), modulo 2^64
};

/// x = n ln 2 + r, |r| <= ln 2 / 2; the Taylor series of exp(r) - 1 up to r^13 leaves 4e-18.
IOTA_ALWAYS_INLINE Reduced reduce_exp(double x) {
  const double shifted = x * 0x1.71547652b82fep+0 + to_integer;
  const double n = shifted - to_integer;
  const double r = (x - n * ln2_high) - n * ln2_low;
  double q = 1.0 / 6227020800;
  q = q * r + 1.0 / 479001600;
  q = q * r + 1.0 / 39916800;
  q = q * r + 1.0 / 3628800;
  q = q * r + 1.0 / 362880;
  q = q * r + 1.0 / 40320;
  q = q * r + 1.0 / 5040;
  q = q * r + 1.0 / 720;
  q = q * r + 1.0 / 120;
  q = q * r + 1.0 / 24;
  q = q * r + 1.0 / 6;
  q = q * r + 0.5;
  const double p = r + r * r * q;
  return {p, std::bit_cast<std::uint64_t>(shifted) - std::bit_cast<std::uint64_t>(to_integer)};
}

struct Angle {
  double sine, cosine;  ///< of the angle minus a whole number of quarter turns
  std::uint64_t quarter;
};

/// Cody and Waite's reduction with pi/2 in four parts of 22 bits (the last of 53): exact up to a thousand million radians.
IOTA_ALWAYS_INLINE Angle reduce_angle(double x) {
  constexpr double p1 = 0x1.921fb0p+0, p2 = 0x1.5110b0p-22, p3 = 0x1.184698p-44, p4 = 0x1.3198a2e037073p-69;
  const double shifted = x * 0x1.45f306dc9c883p-1 + to_integer;
  const double n = shifted - to_integer;
  const double r = ((x - n * p1) - n * p2 - n * p3) - n * p4;
  const double z = r * r;
  double s = 1.0 / 355687428096000;
  s = s * z - 1.0 / 1307674368000;
  s = s * z + 1.0 / 6227020800;
  s = s * z - 1.0 / 39916800;
  s = s * z + 1.0 / 362880;
  s = s * z - 1.0 / 5040;
  s = s * z + 1.0 / 120;
  s = s * z - 1.0 / 6;
  double c = 1.0 / 20922789888000;
  c = c * z - 1.0 / 87178291200;
  c = c * z + 1.0 / 479001600;
  c = c * z - 1.0 / 3628800;
  c = c * z + 1.0 / 40320;
  c = c * z - 1.0 / 720;
  c = c * z + 1.0 / 24;
  const double out_of_range = (x - x) + (std::abs(x) <= 1e9 ? 0.0 : std::numeric_limits<double>::quiet_NaN());
  return {r + r * z * s + out_of_range, (1 - (0.5 * z - z * z * c)) + out_of_range,
          std::bit_cast<std::uint64_t>(shifted)};
}

}  // namespace detail

IOTA_ALWAYS_INLINE double exp(double x) {
  const double inside = x < -746 ? -746 : (x > 710 ? 710 : x);  // NaN is kept
  const auto [p, n] = detail::reduce_exp(inside);
  const std::uint64_t half = ((n + 2048) >> 1) - 1024;
  return ((1 + p) * detail::power_of_two(half)) * detail::power_of_two(n - half);
}

/// log m 2^k = k ln 2 + 2 artanh((m-1)/(m+1)), sqrt(1/2) <= m < sqrt 2.
IOTA_ALWAYS_INLINE double log(double x) {
  const bool tiny = x < 0x1p-1022;
  const double scaled = tiny ? x * 0x1p54 : x;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(scaled);
  constexpr std::uint64_t one = 0x3ff0000000000000, root_half = 0x3fe6a09e667f3bcd;
  const std::uint64_t exponent = (bits + (one - root_half)) >> 52;  // k + 1023
  const double m = std::bit_cast<double>(bits - ((exponent << 52) - one));
  const double k = std::bit_cast<double>(exponent | 0x4330000000000000) - 0x1p52 - 1023 - (tiny ? 54.0 : 0.0);
  const double f = m - 1, s = f / (2 + f), z = s * s;
  double q = 2.0 / 23;
  q = q * z + 2.0 / 21;
  q = q * z + 2.0 / 19;
  q = q * z + 2.0 / 17;
  q = q * z + 2.0 / 15;
  q = q * z + 2.0 / 13;
  q = q * z + 2.0 / 11;
  q = q * z + 2.0 / 9;
  q = q * z + 2.0 / 7;
  q = q * z + 2.0 / 5;
  q = q * z + 2.0 / 3;
  // 2 s = f - s f, so that the leading part is exact.
  const double value = k * detail::ln2_high + (f - (s * (f - z * q) - k * detail::ln2_low));
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double positive = x < infinity ? value : x;  // infinity and NaN are kept
  return x > 0 ? positive : (x == 0 ? -infinity : std::numeric_limits<double>::quiet_NaN());
}

/// Above 1e9 rad the result is NaN, as it would be only round-off.
IOTA_ALWAYS_INLINE double sin(double x) {
  const auto [s, c, quarter] = detail::reduce_angle(x);
  const double v = (quarter & 1) ? c : s;
  return (quarter & 2) ? -v : v;
}
IOTA_ALWAYS_INLINE double cos(double x) {
  const auto [s, c, quarter] = detail::reduce_angle(x);
  const double v = (quarter & 1) ? s : c;
  return ((quarter + 1) & 2) ? -v : v;
}
IOTA_ALWAYS_INLINE double tan(double x) {
  const auto [s, c, quarter] = detail::reduce_angle(x);
  return (quarter & 1) ? -c / s : s / c;
}

IOTA_ALWAYS_INLINE double tanh(double x) {
  const double twice = 2 * x, inside = twice < -44 ? -44 : (twice > 44 ? 44 : twice);
  const auto [p, n] = detail::reduce_exp(inside);
  const double scale = detail::power_of_two(n);
  const double e = scale * p + (scale - 1);  // exp(2x) - 1
  return e / (e + 2);
}

/// exp(b log a): the relative error grows to |b log a| 2e-16. A negative a needs a whole b.
IOTA_ALWAYS_INLINE double pow(double a, double b) {
  const double size = exp(b * log(std::abs(a)));
  const double whole = std::abs(b) < 0x1p52 ? (std::abs(b) + 0x1p52) - 0x1p52 : std::abs(b);
  const bool is_whole = whole == std::abs(b);
  const double half = 0.5 * whole;
  const bool is_odd = std::abs(b) < 0x1p53 && (std::abs(half) + 0x1p52) - 0x1p52 != half && is_whole;
  const double negative = is_whole ? (is_odd ? -size : size) : std::numeric_limits<double>::quiet_NaN();
  const double value = a < 0 ? negative : size;
  return b == 0 ? 1.0 : value;
}

}  // namespace iota::expression
