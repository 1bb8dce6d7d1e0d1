// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/solid.h"

/// Obstacles: see Obstacle.
namespace iota::model {

/// Makes an empty static body one. `shape` has kind, sizes and the key of a mesh that is among the meshes.
void make_obstacle(Structure&, std::uint32_t body, const shape::Data& shape, const SolidPose&);
void move_obstacle(Structure&, std::uint32_t body, const SolidPose&);

}  // namespace iota::model
