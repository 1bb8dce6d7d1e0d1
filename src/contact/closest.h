// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/function_ref.h"

#include <iota/vec3.h>

#include <array>
#include <cstdint>

namespace iota::contact {

/// A farthest point of a convex set in a direction. The number tells corners apart; sets without corners give any number.
struct Support {
  Vec3 place;
  std::uint32_t number = 0;
};
using SupportOf = FunctionRef<Support(const Vec3& direction)>;

/// The points of two convex sets that are nearest to each other.
struct Closest {
  double distance = 0;  ///< m; 0 if they overlap
  Vec3 normal;          ///< unit vector from the second to the first; zero if they overlap
  Vec3 on_first, on_second;
  std::uint32_t count = 0;                         ///< of the supports whose mean the points are
  std::array<std::uint32_t, 4> first{}, second{};  ///< their numbers
};
/// start: a first guess of the vector from the second set to the first. exactness: of the squared distance.
Closest closest(SupportOf first, SupportOf second, const Vec3& start, double exactness = 1e-15);

}  // namespace iota::contact
