// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

CosmeticBondId System::create_cosmetic_bond(ParticleId p, ParticleId q) {
  return implementation_->execute(edit::CreateCosmeticBond{p, q});
}

RestructureReport System::destroy(CosmeticBondId id) {
  return implementation_->execute(edit::Destroy<CosmeticBondId>{id});
}

bool System::contains(CosmeticBondId id) const { return implementation_->model.cosmetic_bonds.contains(id); }

std::vector<CosmeticBondId> System::cosmetic_bonds() const { return implementation_->model.cosmetic_bonds.ids(); }

std::pair<ParticleId, ParticleId> System::ends(CosmeticBondId id) const {
  const model::Model& m = implementation_->model;
  const model::CosmeticBond& b = m.cosmetic_bonds[implementation_->slot(id)];
  return {m.particles.id(b.p), m.particles.id(b.q)};
}

}  // namespace iota
