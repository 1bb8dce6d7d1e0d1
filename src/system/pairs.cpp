// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

PairsId System::create_pairs(const SharedLaw& shared, const PairsOptions& options) {
  const model::Law& law = implementation_->model.laws[implementation_->slot(shared.law)];
  if (shared.implicit.value_or(false))
    throw std::invalid_argument("pairwise forces are taken once a step and held: they cannot be implicit");
  edit::CreatePairs command{shared.law, options.group.value_or(GroupId{}), options.cutoff, law.standard};
  for (const LawParameter& p : shared.parameters) command.parameters[edit::require_parameter(law, p.name)] = p.value;
  return implementation_->execute(command);
}

void System::destroy(PairsId id) { implementation_->execute(edit::Destroy<PairsId>{id}); }

bool System::contains(PairsId id) const { return implementation_->model.pairs.contains(id); }

bool System::is_active(PairsId id) const { return implementation_->model.pairs[implementation_->slot(id)].active; }

void System::set_active(PairsId id, bool active) { implementation_->execute(edit::SetPairsActive{id, active}); }

LawId System::law(PairsId id) const {
  const model::Model& m = implementation_->model;
  return m.laws.id(m.pairs[implementation_->slot(id)].law);
}

double System::cutoff(PairsId id) const { return implementation_->model.pairs[implementation_->slot(id)].cutoff; }

std::vector<LawParameter> System::parameters(PairsId id) const {
  const model::Model& m = implementation_->model;
  const model::Pairs& pairs = m.pairs[implementation_->slot(id)];
  return edit::list_parameters(m.laws[pairs.law], pairs.parameters);
}

void System::set_parameter(PairsId id, std::string_view name, double value) {
  const model::Model& m = implementation_->model;
  const std::uint32_t index = edit::require_parameter(m.laws[m.pairs[implementation_->slot(id)].law], name);
  implementation_->execute(edit::SetPairsParameter{id, index, value});
}

std::vector<PairsId> System::all_pairs() const { return implementation_->model.pairs.ids(); }

double System::energy(PairsId id) const { return implementation_->held.energy_of_pairs(implementation_->slot(id)); }

std::size_t System::rehearse(PairsId id, double dt) {
  return implementation_->held.rehearse_pairs(implementation_->slot(id), dt);
}

}  // namespace iota
