// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <array>
#include <cstdint>
#include <string>

namespace iota::ingredient::joint {

/// A unit vector, for any length, also tiny or huge ones.
Vec3 unit(const Vec3&);

/// The directions that one side of a joint can hold: any if it is the world or has four points not in a plane, those in
/// its plane or along its line if it is flat or thin, none if it is a point.
struct Side {
  static constexpr double straight = 1e-6;  ///< sine of an angle that counts as zero

  std::uint32_t body = none;
  int dimensions = 3;
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  double extent = 0;  ///< m

  Side() = default;  ///< the world
  Side(const Model&, std::uint32_t body);
  bool is_world() const { return body == none; }
  bool holds(Vec3 direction) const;
  std::string what() const;  ///< "body 3 is flat"
};

/// Throws std::invalid_argument.
[[noreturn]] void cannot(const char* kind, const std::string& why);

/// A place of a constraint: its own marker on a body, or a fixed place in the world (body: none).
void add_place(Model&, Constraint&, int place, std::uint32_t body, const Vec3& at);

/// Throws std::invalid_argument if the side cannot hold the frame of a curve or surface.
void require_frame(const char* kind, const Side&);
/// The frame of a curve or surface, on the side whose origin is given.
void make_frame(Model&, Constraint&, const Side&, int origin, const Vec3& at, const Quaternion&);

}  // namespace iota::ingredient::joint
