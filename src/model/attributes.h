// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/attributes.h>
#include <iota/vec3.h>

#include <array>
#include <cstdint>

namespace iota::model {

/// Rare attributes of a particle: lifetime, look, orientation.
struct Attributes {
  std::uint32_t particle = 0xffffffff, emitter = 0xffffffff;
  double age = 0, lifetime = std::numeric_limits<double>::infinity();  ///< s
  double radius = 0;                                                   ///< m
  Color color{1, 1, 1, 1};

  // An oriented particle rotates like a ball: its moment of inertia is the same about every axis.
  std::uint32_t oriented = 0, padding = 0;
  Quaternion orientation;
  Vec3 spin;                                    ///< rad/s, world
  Vec3 torque;                                  ///< for the next step only, N m
  double moment = 0, damping = 0;               ///< kg m^2, 1/s
  Vec3 preferred;                               ///< unit direction for its local z, world
  double stiffness = 0, alignment_damping = 0;  ///< N m / rad, N m s
};

}  // namespace iota::model
