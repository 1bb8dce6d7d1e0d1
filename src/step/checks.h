// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/text.h"

#include <iota/ids.h>
#include <iota/system.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

/// Checks of what a user passes in: they name the argument and its value, and throw before anything has changed.
namespace iota::step {

using iota::text;

inline std::string text_of(const Vec3& v) { return text("(", v.x, ", ", v.y, ", ", v.z, ")"); }

inline void require_finite(std::string_view name, const Vec3& v) {
  if (!is_finite(v)) throw std::invalid_argument(text(name, " must be finite, got ", text_of(v)));
  constexpr double limit = 1e9;  // meters or m/s: beyond it a double no longer resolves micrometers
  if (std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > limit)
    throw std::invalid_argument(text(name, " must have no component above 1e9, got ", text_of(v)));
}
inline void require_positive(std::string_view name, double v) {
  if (!(v > 0) || !std::isfinite(v)) throw std::invalid_argument(text(name, " must be positive and finite, got ", v));
}
inline void require_mass(std::string_view name, double v) {
  require_positive(name, v);
  if (v < 1e-12 || v > 1e15) throw std::invalid_argument(text(name, " must be between 1e-12 and 1e15 kg, got ", v));
}
inline void require_not_negative(std::string_view name, double v) {
  if (!(v >= 0) || !std::isfinite(v))
    throw std::invalid_argument(text(name, " must be zero or more and finite, got ", v));
}

template <class IdType>
[[noreturn]] void throw_stale(std::string_view kind, IdType id, const std::optional<IdType>& survivor) {
  if (!id) throw StaleIdError(text("this ", kind, " id is null: it never named a ", kind));
  if (survivor)
    throw StaleIdError(text(kind, " ", id.slot, " is gone: it was absorbed by ", kind, " ", survivor->slot));
  throw StaleIdError(text(kind, " ", id.slot, " is gone: it was destroyed"));
}

}  // namespace iota::step
