// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

PairsId Pairs::create(const SharedLaw& shared, const PairsOptions& options) {
  const ingredient::Law& law = core_.model.laws[core_.slot(shared.law)];
  if (shared.implicit.value_or(false))
    throw std::invalid_argument("pairwise forces are taken once a step and held: they cannot be implicit");
  edit::CreatePairs command{shared.law,
                            options.group.value_or(GroupId{}),
                            options.other.value_or(GroupId{}),
                            options.shifted,
                            options.cutoff,
                            law.standard};
  for (const LawParameter& p : shared.parameters) command.parameters[edit::require_parameter(law, p.name)] = p.value;
  return core_.execute(command);
}

void Pairs::destroy(PairsId id) { core_.execute(edit::Destroy<PairsId>{id}); }

bool Pairs::contains(PairsId id) const { return core_.model.pairs.contains(id); }

bool Pairs::is_active(PairsId id) const { return core_.model.pairs[core_.slot(id)].active; }

void Pairs::set_active(PairsId id, bool active) { core_.execute(edit::SetPairsActive{id, active}); }

LawId Pairs::law(PairsId id) const {
  const model::Model& m = core_.model;
  return m.laws.id(m.pairs[core_.slot(id)].law);
}

double Pairs::cutoff(PairsId id) const { return core_.model.pairs[core_.slot(id)].cutoff; }

std::optional<GroupId> Pairs::group(PairsId id) const {
  return edit::group_at(core_.model, core_.model.pairs[core_.slot(id)].group);
}

std::optional<GroupId> Pairs::other(PairsId id) const {
  return edit::group_at(core_.model, core_.model.pairs[core_.slot(id)].other);
}

bool Pairs::is_shifted(PairsId id) const { return core_.model.pairs[core_.slot(id)].shifted != 0; }

std::vector<LawParameter> Pairs::parameters(PairsId id) const {
  const model::Model& m = core_.model;
  const ingredient::PairForce& pairs = m.pairs[core_.slot(id)];
  return edit::list_parameters(m.laws[pairs.law], pairs.parameters);
}

void Pairs::set_parameter(PairsId id, std::string_view name, double value) {
  const model::Model& m = core_.model;
  const std::uint32_t index = edit::require_parameter(m.laws[m.pairs[core_.slot(id)].law], name);
  core_.execute(edit::SetPairsParameter{id, index, value});
}

std::vector<PairsId> Pairs::ids() const { return core_.model.pairs.ids(); }

double Pairs::energy(PairsId id) const { return core_.held.energy_of_pairs(core_.slot(id)); }

std::size_t Pairs::rehearse(PairsId id, double dt) { return core_.held.rehearse_pairs(core_.slot(id), dt); }

}  // namespace iota
