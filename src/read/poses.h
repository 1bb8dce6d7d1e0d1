// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "held/held_forces.h"
#include "read/orientations.h"

#include <iota/pose_snapshot.h>

/// The data of each step for viewers.
namespace iota::read {

PoseSnapshot poses(model::Model&, held::HeldForces&, Orientations&);

/// As `structure_version`, without births and deaths of sparks: changes when a viewer's list of bodies does.
inline std::uint32_t scene_version(const model::Model& model) { return model.structure_version - model.spark_changes; }

}  // namespace iota::read
