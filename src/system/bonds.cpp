// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

void System::set_break_force(BondId id, double force) { implementation_->execute(edit::SetBondBreakForce{id, force}); }

double System::break_force(BondId id) const {
  return implementation_->model.bonds[implementation_->slot(id)].break_force;
}

bool System::is_broken(BondId id) const { return implementation_->model.bonds[implementation_->slot(id)].broken; }

Vec3 System::force(BondId id) const { return implementation_->held.force(implementation_->slot(id)); }

BondId System::create_bond(ParticleId p, ParticleId q, BondLaw body) {
  Core& core = *implementation_;
  const auto law_id = [&](std::uint32_t slot) { return core.model.laws.id(slot); };
  edit::CreateBond command{p, q, {}, true, 0, {}};
  if (const auto* spring = std::get_if<SpringLaw>(&body)) {
    command.law = law_id(model::spring_law);
    command.parameters = {spring->stiffness, spring->damping, spring->length};
  } else if (const auto* drag = std::get_if<DragLaw>(&body)) {
    command.law = law_id(model::drag_law);
    command.parameters = {drag->damping};
  } else if (auto* scripted = std::get_if<ScriptedLaw>(&body)) {
    if (!scripted->force) throw std::invalid_argument("a scripted bond needs a function");
    held::Functions& functions = core.held.functions;
    command.law = law_id(model::scripted_law), command.implicit = false, command.script = functions.next_key;
    const BondId id = core.execute(command);
    functions.of_bonds[functions.next_key++] = std::move(*scripted);
    return id;
  } else {
    const SharedLaw& shared = std::get<SharedLaw>(body);
    const model::Law& law = core.model.laws[core.slot(shared.law)];
    if (law.kind == model::LawKind::scripted)
      throw std::invalid_argument("a bond with a function of its own is made with a ScriptedLaw");
    command.law = shared.law, command.parameters = law.standard;
    command.implicit = shared.implicit.value_or(law.has_derivative());
    for (const LawParameter& parameter : shared.parameters)
      command.parameters[edit::require_parameter(law, parameter.name)] = parameter.value;
  }
  return core.execute(command);
}

LawId System::law(BondId id) const {
  const model::Model& m = implementation_->model;
  return m.laws.id(m.bonds[implementation_->slot(id)].law);
}

bool System::is_implicit(BondId id) const {
  return implementation_->model.bonds[implementation_->slot(id)].implicit;
}

std::vector<LawParameter> System::parameters(BondId id) const {
  const model::Model& m = implementation_->model;
  const model::Bond& bond = m.bonds[implementation_->slot(id)];
  return edit::list_parameters(m.laws[bond.law], bond.parameters);
}

void System::set_parameter(BondId id, std::string_view name, double value) {
  const model::Model& m = implementation_->model;
  const std::uint32_t index = edit::require_parameter(m.laws[m.bonds[implementation_->slot(id)].law], name);
  implementation_->execute(edit::SetBondParameter{id, index, value});
}

void System::destroy(BondId id) { implementation_->execute(edit::Destroy<BondId>{id}); }

void System::set_active(BondId bond, bool active) { implementation_->execute(edit::SetBondActive{bond, active}); }

bool System::contains(BondId id) const { return implementation_->model.bonds.contains(id); }

std::vector<BondId> System::bonds() const { return implementation_->model.bonds.ids(); }

std::pair<ParticleId, ParticleId> System::ends(BondId id) const {
  const model::Model& m = implementation_->model;
  const model::Bond& b = m.bonds[implementation_->slot(id)];
  return {m.particles.id(b.p), m.particles.id(b.q)};
}

bool System::is_active(BondId id) const { return implementation_->model.bonds[implementation_->slot(id)].active; }

}  // namespace iota
