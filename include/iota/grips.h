// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <cstdint>
#include <vector>

namespace iota {

struct GripOptions {
  std::uint32_t client = 0, hold = 0;  ///< whose grip; carried to the viewers
  double frequency = 2.5;              ///< Hz of the critically damped spring
  double max_acceleration = 60;        ///< m/s^2: the force is at most this times the effective mass
};

/// Grips: springs from a point of a body to a target that a user moves.
class Grips : public View {
 public:
  explicit Grips(Core& core) : View(core) {}

  /// local_point: in the body's drawn frame, m; it is moved to the nearest place that the body's particles span.
  GripId create(BodyId body, const Vec3& local_point, const Vec3& target, const GripOptions& options = {});
  void move(GripId, const Vec3& target);
  void destroy(GripId);
  bool contains(GripId) const;
  std::vector<GripId> ids() const;  ///< in order of slots
  /// The body that it holds now: an edit may have made that another one than at the start.
  BodyId body(GripId) const;
};

}  // namespace iota
