// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

void Bonds::set_break_force(BondId id, double force) { core_.execute(edit::SetBondBreakForce{id, force}); }

double Bonds::break_force(BondId id) const { return core_.model.bonds[core_.slot(id)].break_force; }

bool Bonds::is_broken(BondId id) const { return core_.model.bonds[core_.slot(id)].broken; }

Vec3 Bonds::force(BondId id) const { return ingredient::Bonds::force_on_first(core_.model, core_.slot(id)); }

BondId Bonds::create(ParticleId p, ParticleId q, BondLaw body) {
  const auto law_id = [&](std::uint32_t slot) { return core_.model.laws.id(slot); };
  edit::CreateBond command{p, q, {}, true, 0, {}};
  if (const auto* spring = std::get_if<SpringLaw>(&body)) {
    command.law = law_id(ingredient::spring_law);
    command.parameters = {spring->stiffness, spring->damping, spring->length};
  } else if (const auto* drag = std::get_if<DragLaw>(&body)) {
    command.law = law_id(ingredient::drag_law);
    command.parameters = {drag->damping};
  } else if (auto* scripted = std::get_if<ScriptedLaw>(&body)) {
    if (!scripted->force) throw std::invalid_argument("a scripted bond needs a function");
    held::Functions& functions = core_.held.functions;
    command.law = law_id(ingredient::scripted_law), command.implicit = false, command.script = functions.next_key;
    const BondId id = core_.execute(command);
    functions.of_bonds[functions.next_key++] = std::move(*scripted);
    return id;
  } else {
    const SharedLaw& shared = std::get<SharedLaw>(body);
    const ingredient::Law& law = core_.model.laws[core_.slot(shared.law)];
    if (law.kind == ingredient::LawKind::scripted)
      throw std::invalid_argument("a bond with a function of its own is made with a ScriptedLaw");
    command.law = shared.law, command.parameters = law.standard;
    command.implicit = shared.implicit.value_or(law.has_derivative());
    for (const LawParameter& parameter : shared.parameters)
      command.parameters[edit::require_parameter(law, parameter.name)] = parameter.value;
  }
  return core_.execute(command);
}

LawId Bonds::law(BondId id) const {
  const model::Model& m = core_.model;
  return m.laws.id(m.bonds[core_.slot(id)].law);
}

bool Bonds::is_implicit(BondId id) const { return core_.model.bonds[core_.slot(id)].implicit; }

std::vector<LawParameter> Bonds::parameters(BondId id) const {
  const model::Model& m = core_.model;
  const ingredient::Bond& bond = m.bonds[core_.slot(id)];
  return edit::list_parameters(m.laws[bond.law], bond.parameters);
}

void Bonds::set_parameter(BondId id, std::string_view name, double value) {
  const model::Model& m = core_.model;
  const std::uint32_t index = edit::require_parameter(m.laws[m.bonds[core_.slot(id)].law], name);
  core_.execute(edit::SetBondParameter{id, index, value});
}

void Bonds::destroy(BondId id) { core_.execute(edit::Destroy<BondId>{id}); }

void Bonds::set_active(BondId bond, bool active) { core_.execute(edit::SetBondActive{bond, active}); }

bool Bonds::contains(BondId id) const { return core_.model.bonds.contains(id); }

std::vector<BondId> Bonds::ids() const { return core_.model.bonds.ids(); }

std::pair<ParticleId, ParticleId> Bonds::ends(BondId id) const {
  const model::Model& m = core_.model;
  const ingredient::Bond& b = m.bonds[core_.slot(id)];
  return {m.particles.id(b.p), m.particles.id(b.q)};
}

bool Bonds::is_active(BondId id) const { return core_.model.bonds[core_.slot(id)].active; }

}  // namespace iota
