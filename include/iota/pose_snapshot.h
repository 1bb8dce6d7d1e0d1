// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace iota {

/// Drawn pose of a body. The local frame has its origin at the center of mass; for a body whose particles lie on one
/// line, local +x runs from its first particle to its last.
struct BodyPose {
  std::uint32_t body;    ///< slot of the BodyId
  float position[3];     ///< world frame, m
  float orientation[4];  ///< unit quaternion x y z w
};

/// A free particle of an emitter: drawn as a dot.
struct SparkPose {
  float position[3];    ///< world frame, m
  float radius;         ///< m
  std::uint32_t color;  ///< 0xRRGGBB
  std::uint32_t set;    ///< slot of its emitter
};

/// A user's grip on a body: the spring from `point` to `target`.
struct HoldPose {
  std::uint32_t client, hold, body;
  float point[3], target[3];  ///< world frame, m
  float force;                ///< N
};

/// State for viewers at one time: an immutable copy, safe to pass to another thread.
struct PoseSnapshot {
  std::uint64_t step = 0;
  double time = 0;                      ///< s
  std::uint32_t structure_version = 0;  ///< System::structure_version
  float kinetic = 0, potential = 0;     ///< J
  float gap = 0;                        ///< worst hinge separation or rigidity error, m
  std::vector<BodyPose> bodies;
  std::vector<SparkPose> sparks;
  std::vector<HoldPose> holds;
};

}  // namespace iota
