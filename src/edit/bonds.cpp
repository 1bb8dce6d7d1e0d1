// SPDX-License-Identifier: Apache-2.0
#include "edit/bonds.h"

#include "edit/law_checks.h"
#include "math/checks.h"

#include <cmath>

namespace iota::edit {

namespace {

double parameter_of(const Editor& e, const CreateBond& c, std::uint32_t i) {
  const model::Model& model = e.model;
  return std::isnan(c.parameters[i]) ? norm(model.position(c.q.slot) - model.position(c.p.slot)) : c.parameters[i];
}

}  // namespace

void check(const Editor& e, const CreateBond& c) {
  const model::Model& model = e.model;
  const std::uint32_t p = e.require(c.p), q = e.require(c.q), slot = e.require(c.law);
  if (p == q) throw std::invalid_argument(text("a bond needs two particles, got particle ", p, " twice"));
  const ingredient::Law& law = model.laws[slot];
  if (law.has_derivative() && model.compiled(slot).depends_on_normals())
    throw std::invalid_argument(text("the law ", law.name.data(),
                                     " depends on normals (cos_p, cos_q, cos_pq): only pairwise forces know them"));
  if (c.implicit && !law.has_derivative())
    throw std::invalid_argument(
        text("the law ", law.name.data(), " is code without a derivative: its bonds cannot be implicit"));
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) require_parameter_value(law, i, parameter_of(e, c, i));
}

BondId apply(Editor& e, const CreateBond& c) {
  check(e, c);
  model::Model& model = e.model;
  ingredient::Bond bond;
  bond.p = c.p.slot, bond.q = c.q.slot, bond.law = c.law.slot, bond.implicit = c.implicit, bond.script = c.script;
  for (std::uint32_t i = 0; i < model.laws[bond.law].parameter_count; ++i) bond.parameters[i] = parameter_of(e, c, i);
  e.structure_changed();
  return model.bonds.id(ingredient::Bonds::add(model, bond));
}

void check(const Editor& e, const SetBondParameter& c) {
  const model::Model& model = e.model;
  const auto& law = model.laws[model.bonds[e.require(c.bond)].law];
  if (c.index >= law.parameter_count) throw std::invalid_argument("set_parameter: no such parameter");
  require_parameter_value(law, c.index, c.value);
}

void apply(Editor& e, const SetBondParameter& c) {
  model::Model& model = e.model;
  ingredient::Bond& bond = model.bonds[e.require(c.bond)];
  model.changed_bonds.note(c.bond.slot);
  set_parameter(model.laws[bond.law], bond.parameters, c.index, c.value);
  ingredient::Bonds::parameter_changed(model, c.bond.slot);
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
