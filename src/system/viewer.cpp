// SPDX-License-Identifier: Apache-2.0
#include "read/poses.h"
#include "system/core.h"

namespace iota {

PoseSnapshot System::poses() const { return read::poses(implementation_->model, implementation_->held, implementation_->orientations); }

std::uint32_t System::scene_version() const { return read::scene_version(implementation_->model); }

bool System::is_spark(BodyId id) const {
  const std::uint32_t first = implementation_->model.bodies[implementation_->slot(id)].first;
  return first != model::none && implementation_->model.is_spark(first);
}

}  // namespace iota
