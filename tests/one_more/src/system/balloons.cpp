// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

BalloonId Balloons::create(ParticleId particle, const Vec3& lift) {
  return core_.execute(ingredient::CreateBalloon{particle, lift});
}

void Balloons::set_lift(BalloonId id, const Vec3& lift) { core_.execute(ingredient::SetLift{id, lift}); }

void Balloons::destroy(BalloonId id) { core_.execute(edit::Destroy<BalloonId>{id}); }

bool Balloons::contains(BalloonId id) const { return core_.model.balloons.contains(id); }

std::vector<BalloonId> Balloons::ids() const { return core_.model.balloons.ids(); }

Vec3 Balloons::lift(BalloonId id) const { return core_.model.balloons[core_.slot(id)].lift; }

}  // namespace iota
