// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

EmitterId System::create_emitter(const EmitterOptions& options) {
  return implementation_->execute(edit::CreateEmitter{options});
}

void System::destroy(EmitterId id) { implementation_->execute(edit::Destroy<EmitterId>{id}); }

void System::set_active(EmitterId id, bool active) { implementation_->execute(edit::SetEmitterActive{id, active}); }

void System::set_rate(EmitterId id, double per_second) { implementation_->execute(edit::SetRate{id, per_second}); }

void System::move_emitter(EmitterId id, const Vec3& position, const Quaternion& orientation) {
  implementation_->execute(edit::MoveEmitter{id, position, orientation});
}

bool System::contains(EmitterId id) const { return implementation_->model.emitters.contains(id); }

bool System::is_active(EmitterId id) const {
  return implementation_->model.emitters[implementation_->slot(id)].active;
}

double System::rate(EmitterId id) const { return implementation_->model.emitters[implementation_->slot(id)].rate; }

std::uint32_t System::count(EmitterId id) const {
  return implementation_->model.emitters[implementation_->slot(id)].alive;
}

std::uint64_t System::born(EmitterId id) const {
  return implementation_->model.emitters[implementation_->slot(id)].born;
}

std::vector<ParticleId> System::particles(EmitterId id) const {
  const model::Model& m = implementation_->model;
  const std::uint32_t slot = implementation_->slot(id);
  std::vector<ParticleId> ids;
  m.attributes.for_each([&](std::uint32_t, const model::Attributes& a) {
    if (a.emitter == slot) ids.push_back(m.particles.id(a.particle));
  });
  return ids;
}

}  // namespace iota
