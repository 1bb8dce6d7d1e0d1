// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "held/held_forces.h"
#include "read/orientations.h"

#include <iota/pose_snapshot.h>

/// What viewers are told of each step.
namespace iota::read {

PoseSnapshot poses(model::Model&, held::HeldForces&, Orientations&);

/// As `structure_version`, but births and deaths of sparks do not count: what a viewer's list of bodies depends on.
inline std::uint32_t scene_version(const model::Model& model) { return model.structure_version - model.spark_changes; }

}  // namespace iota::read
