// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

void System::destroy(GripId id) { implementation_->execute(edit::Destroy<GripId>{id}); }

GripId System::create_grip(BodyId body, const Vec3& local_point, const Vec3& target, const GripOptions& options) {
  return implementation_->execute(edit::CreateGrip{body, local_point, target, options});
}

void System::move_grip(GripId grip, const Vec3& target) { implementation_->execute(edit::MoveGrip{grip, target}); }

bool System::contains(GripId id) const { return implementation_->model.grips.contains(id); }

}  // namespace iota
