// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "math/text.h"

#include <iota/emitters.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

/// Checks of numbers that a user passes in: they name the argument and its value, and throw std::invalid_argument.
namespace iota::edit {

inline void require_number(std::string_view name, double v) {
  if (!std::isfinite(v)) throw std::invalid_argument(text(name, " must be finite, got ", v));
}

inline void require_finite(std::string_view name, const Vec3& v) {
  if (!is_finite(v)) throw std::invalid_argument(text(name, " must be finite, got ", text_of(v)));
  constexpr double limit = 1e9;  // meters or m/s: beyond it a double no longer resolves micrometers
  if (std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > limit)
    throw std::invalid_argument(text(name, " must have no component above 1e9, got ", text_of(v)));
}

inline void require_positive(std::string_view name, double v) {
  if (!(v > 0) || !std::isfinite(v)) throw std::invalid_argument(text(name, " must be positive and finite, got ", v));
}

inline void require_size(std::string_view name, double v) {
  if (!(v > 0 && v <= 1e9)) throw std::invalid_argument(text(name, " must be above 0 and at most 1e9 m, got ", v));
}

inline void require_mass(std::string_view name, double v) {
  require_positive(name, v);
  if (v < 1e-30 || v > 1e15) throw std::invalid_argument(text(name, " must be between 1e-30 and 1e15 kg, got ", v));
}

inline void require_not_negative(std::string_view name, double v) {
  if (!(v >= 0) || !std::isfinite(v))
    throw std::invalid_argument(text(name, " must be zero or more and finite, got ", v));
}

inline void require_break_force(double newtons, std::string_view name = "break_force") {
  if (!(newtons > 0)) throw std::invalid_argument(text(name, " must be above zero, got ", newtons));
}

inline void require_color(const Color& color) {
  for (const float part : color) require_number("each part of a color", static_cast<double>(part));
}

/// The unit quaternion along q; refuses one without a direction.
inline Quaternion require_quaternion(std::string_view name, const Quaternion& q) {
  const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!(length2 > 1e-12) || !std::isfinite(length2))
    throw std::invalid_argument(text(name, " must be a quaternion x y z w that is finite and not zero, got (", q.x,
                                     ", ", q.y, ", ", q.z, ", ", q.w, ")"));
  return normalized(q);
}

}  // namespace iota::edit
