// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

AngleSpringId AngleSprings::create(ParticleId p, ParticleId middle, ParticleId q, const AngleSpringOptions& options) {
  return core_.execute(ingredient::CreateAngleSpring{p, middle, q, options.stiffness, options.damping, options.rest});
}

void AngleSprings::set(AngleSpringId id, const AngleSpringOptions& options) {
  core_.execute(ingredient::SetAngleSpring{id, options.stiffness, options.damping, options.rest});
}

void AngleSprings::destroy(AngleSpringId id) { core_.execute(edit::Destroy<AngleSpringId>{id}); }

bool AngleSprings::contains(AngleSpringId id) const { return core_.model.angle_springs.contains(id); }

std::vector<AngleSpringId> AngleSprings::ids() const { return core_.model.angle_springs.ids(); }

std::array<ParticleId, 3> AngleSprings::ends(AngleSpringId id) const {
  const model::Model& m = core_.model;
  const auto& [p, middle, q] = m.angle_springs[core_.slot(id)].particles;
  return {m.particles.id(p), m.particles.id(middle), m.particles.id(q)};
}

AngleSpringOptions AngleSprings::options(AngleSpringId id) const {
  const ingredient::AngleSpring& spring = core_.model.angle_springs[core_.slot(id)];
  return {spring.stiffness, spring.damping, spring.rest};
}

double AngleSprings::angle(AngleSpringId id) const {
  return ingredient::AngleSprings::angle(core_.model, core_.model.angle_springs[core_.slot(id)]);
}

double AngleSprings::moment(AngleSpringId id) const {
  return ingredient::AngleSprings::moment(core_.model, core_.slot(id));
}

}  // namespace iota
