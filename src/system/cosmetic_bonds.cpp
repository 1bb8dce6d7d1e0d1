// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

CosmeticBondId CosmeticBonds::create(ParticleId p, ParticleId q) {
  return core_.execute(edit::CreateCosmeticBond{p, q});
}

RestructureReport CosmeticBonds::destroy(CosmeticBondId id) { return core_.execute(edit::Destroy<CosmeticBondId>{id}); }

bool CosmeticBonds::contains(CosmeticBondId id) const { return core_.model.cosmetic_bonds.contains(id); }

std::vector<CosmeticBondId> CosmeticBonds::ids() const { return core_.model.cosmetic_bonds.ids(); }

std::pair<ParticleId, ParticleId> CosmeticBonds::ends(CosmeticBondId id) const {
  const model::Model& m = core_.model;
  const ingredient::CosmeticBond& b = m.cosmetic_bonds[core_.slot(id)];
  return {m.particles.id(b.p), m.particles.id(b.q)};
}

}  // namespace iota
