// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "math/text.h"

#include <iota/attributes.h>
#include <iota/materials.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

/// Checks of numbers that a user passes in: they name the argument and its value, and throw std::invalid_argument.
namespace iota {

/// Throws "`name` must `condition`, got `value`". Not inline: a check that passes is a comparison.
[[noreturn]] void refuse(std::string_view name, std::string_view condition, double value);
[[noreturn]] void refuse(std::string_view name, std::string_view condition, const Vec3& value);
[[noreturn]] void refuse(std::string_view name, std::string_view condition, const Quaternion& value);

inline void require_number(std::string_view name, double v) {
  if (!std::isfinite(v)) refuse(name, "be finite", v);
}

inline void require_finite(std::string_view name, const Vec3& v) {
  constexpr double limit = 1e9;  // meters or m/s: beyond it a double no longer resolves micrometers
  if (std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit) return;
  refuse(name, is_finite(v) ? "have no component above 1e9" : "be finite", v);
}

inline void require_positive(std::string_view name, double v) {
  if (!(v > 0) || !std::isfinite(v)) refuse(name, "be positive and finite", v);
}

inline void require_size(std::string_view name, double v) {
  if (!(v > 0 && v <= 1e9)) refuse(name, "be above 0 and at most 1e9 m", v);
}

inline void require_mass(std::string_view name, double v) {
  if (v >= 1e-30 && v <= 1e15) return;
  require_positive(name, v);
  refuse(name, "be between 1e-30 and 1e15 kg", v);
}

inline void require_not_negative(std::string_view name, double v) {
  if (!(v >= 0) || !std::isfinite(v)) refuse(name, "be zero or more and finite", v);
}

inline void require_material(const Material& material) {
  require_not_negative("friction", material.friction);
  if (!(material.restitution >= 0 && material.restitution <= 1))
    refuse("restitution", "be between 0 and 1", material.restitution);
  require_not_negative("rolling", material.rolling);
  require_not_negative("spinning", material.spinning);
  require_not_negative("static_friction", material.static_friction);
  if (material.static_friction != 0 && material.static_friction < material.friction)
    refuse("static_friction", "be 0 or at least the friction", material.static_friction);
  if (!is_finite(material.surface_velocity)) throw std::invalid_argument("surface_velocity must be finite");
}

inline void require_break_force(double newtons, std::string_view name = "break_force") {
  if (!(newtons > 0)) refuse(name, "be above zero", newtons);
}

inline void require_color(const Color& color) {
  for (const float part : color) require_number("each part of a color", static_cast<double>(part));
}

/// The unit quaternion along q; refuses one without a direction.
inline Quaternion require_quaternion(std::string_view name, const Quaternion& q) {
  const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!(length2 > 1e-12) || !std::isfinite(length2))
    refuse(name, "be a quaternion x y z w that is finite and not zero", q);
  return normalized(q);
}

}  // namespace iota
