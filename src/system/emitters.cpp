// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

EmitterId Emitters::create(const EmitterOptions& options) { return core_.execute(edit::CreateEmitter{options}); }

void Emitters::destroy(EmitterId id) { core_.execute(edit::Destroy<EmitterId>{id}); }

void Emitters::set_active(EmitterId id, bool active) { core_.execute(edit::SetEmitterActive{id, active}); }

void Emitters::set_rate(EmitterId id, double per_second) { core_.execute(edit::SetRate{id, per_second}); }

void Emitters::move(EmitterId id, const Vec3& position, const Quaternion& orientation) {
  core_.execute(edit::MoveEmitter{id, position, orientation});
}

bool Emitters::contains(EmitterId id) const { return core_.model.emitters.contains(id); }

bool Emitters::is_active(EmitterId id) const { return core_.model.emitters[core_.slot(id)].active; }

double Emitters::rate(EmitterId id) const { return core_.model.emitters[core_.slot(id)].rate; }

std::uint32_t Emitters::count(EmitterId id) const { return core_.model.emitters[core_.slot(id)].alive; }

std::uint64_t Emitters::born(EmitterId id) const { return core_.model.emitters[core_.slot(id)].born; }

std::vector<ParticleId> Emitters::particles(EmitterId id) const {
  const model::Model& m = core_.model;
  const std::uint32_t slot = core_.slot(id);
  std::vector<ParticleId> ids;
  m.attributes.for_each([&](std::uint32_t, const model::Attributes& a) {
    if (a.emitter == slot) ids.push_back(m.particles.id(a.particle));
  });
  return ids;
}

}  // namespace iota
