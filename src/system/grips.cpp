// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

void Grips::destroy(GripId id) { core_.execute(edit::Destroy<GripId>{id}); }

GripId Grips::create(BodyId body, const Vec3& local_point, const Vec3& target, const GripOptions& options) {
  return core_.execute(edit::CreateGrip{body, local_point, target, options});
}

void Grips::move(GripId grip, const Vec3& target) { core_.execute(edit::MoveGrip{grip, target}); }

std::vector<GripId> Grips::ids() const { return core_.model.grips.ids(); }

bool Grips::contains(GripId id) const { return core_.model.grips.contains(id); }

BodyId Grips::body(GripId id) const {
  const model::Model& m = core_.model;
  return m.bodies.id(m.grips[core_.slot(id)].body);
}

}  // namespace iota
