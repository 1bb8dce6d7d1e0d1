// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cstdint>

namespace iota {

/// An event that a viewer shows for a moment, and its place.
struct ViewEvent {
  enum class Kind : std::uint8_t { join, break_ };
  Kind kind = Kind::join;
  Vec3 position;  ///< m
};

}  // namespace iota
