// SPDX-License-Identifier: Apache-2.0
#include "read/poses.h"
#include "system/core.h"

namespace iota {

PoseSnapshot Viewer::poses() const { return read::poses(core_.model, core_.held, core_.orientations); }

std::uint32_t Viewer::scene_version() const { return read::scene_version(core_.model); }

bool Viewer::is_spark(BodyId id) const {
  const std::uint32_t first = core_.model.bodies[core_.slot(id)].first;
  return first != model::none && core_.model.is_spark(first);
}

}  // namespace iota
