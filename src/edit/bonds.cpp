// SPDX-License-Identifier: Apache-2.0
#include "edit/bonds.h"

#include "edit/checks.h"
#include "edit/law_checks.h"

#include <cmath>

namespace iota::edit {

BondId apply(Editor& e, const CreateBond& c) {
  model::Model& model = e.model;
  const std::uint32_t p = e.require(c.p), q = e.require(c.q), slot = e.require(c.law);
  if (p == q) throw std::invalid_argument(text("a bond needs two particles, got particle ", p, " twice"));
  const ingredient::Law& law = model.laws[slot];
  if (c.implicit && !law.has_derivative())
    throw std::invalid_argument(
        text("the law ", law.name.data(), " is code without a derivative: its bonds cannot be implicit"));
  ingredient::Bond bond;
  bond.p = p, bond.q = q, bond.law = slot, bond.implicit = c.implicit, bond.script = c.script;
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    const double value = c.parameters[i];
    bond.parameters[i] = std::isnan(value) ? norm(model.position(q) - model.position(p)) : value;
    require_parameter_value(law, i, bond.parameters[i]);
  }
  e.structure_changed();
  return model.bonds.id(ingredient::Bonds::add(model, bond));
}

void apply(Editor& e, const SetBondParameter& c) {
  model::Model& model = e.model;
  ingredient::Bond& bond = model.bonds[e.require(c.bond)];
  model.changed_bonds.note(c.bond.slot);
  set_parameter(model.laws[bond.law], bond.parameters, c.index, c.value);
}

void apply(Editor& e, const SetBondActive& c) { ingredient::Bonds::set_active(e.model, e.require(c.bond), c.active); }

void apply(Editor& e, const SetBondBreakForce& c) {
  model::Model& model = e.model;
  const std::uint32_t bond = e.require(c.bond);
  require_break_force(c.force);
  model.bonds[bond].break_force = c.force;
  ++model.bonds_revision;
}

void apply(Editor& e, const Destroy<BondId>& c) {
  model::Model& model = e.model;
  const std::uint32_t bond = e.require(c.id);
  e.drop_function(e.held.functions.of_bonds, model.bonds[bond].script);
  ingredient::Bonds::remove(model, bond);
  e.structure_changed();
}

}  // namespace iota::edit
