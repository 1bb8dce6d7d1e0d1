// SPDX-License-Identifier: Apache-2.0
// Laws and the bonds that use them: making, changing, destroying; and what System says of them.
#include "step/execute.h"
#include "step/law_checks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace iota {

using namespace step;

namespace {

static_assert(max_law_parameters == laws::max_parameters);

model::Law make_law(const LawBody& body, const LawOptions& options) {
  model::Law law;
  put_text(law.name, options.name, "the name of a law");
  put_parameters(law.parameters, law.standard, law.parameter_count, options.parameters, laws::PairLaw::variables);
  if (const auto* expression = std::get_if<std::string>(&body)) {
    law.kind = model::LawKind::expression;
    put_text(law.text, *expression, "the text of a law");
  } else {
    law.kind = std::holds_alternative<RadialFunction>(body) ? model::LawKind::radial : model::LawKind::batch;
  }
  return law;
}

}  // namespace

std::uint32_t System::Implementation::require(LawId id) const {
  if (!model.laws.contains(id)) throw_stale("law", id, std::optional<LawId>{});
  return id.slot;
}

void System::Implementation::apply(const step::Spell& c) {
  constexpr std::size_t longest = 4096;
  if (spelled.size() >= longest) spelled.clear();
  spelled.insert(spelled.end(), c.piece.begin(), c.piece.end());
}

void System::Implementation::spell(const void* record, std::size_t size) {
  const auto* bytes = static_cast<const std::byte*>(record);
  spelled.clear();
  for (std::size_t at = 0; at < size;) {
    step::Spell piece{};
    const std::size_t part = std::min(piece.piece.size(), size - at);
    std::copy_n(bytes + at, part, piece.piece.begin());
    execute(piece);
    at += part;
  }
}

LawId System::Implementation::apply(const step::CreateLaw&) {
  if (spelled.size() < sizeof(model::Law)) throw std::invalid_argument("the record of a law is cut short");
  model::Law law;
  std::memcpy(&law, spelled.data(), sizeof law);
  spelled.clear();
  if (law.kind == model::LawKind::listed || law.kind == model::LawKind::scripted || law.kind > model::LawKind::batch)
    throw std::invalid_argument("the record of a law is damaged");
  law.parameter_count = std::min<std::uint32_t>(law.parameter_count, law.parameters.size());
  law.uses = 0;
  law.name.back() = law.text.back() = '\0';
  for (auto& name : law.parameters) name.back() = '\0';
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    if (!std::isnan(law.standard[i])) require_parameter_value(law, i, law.standard[i]);
  return model.laws.id(model.make_law(law));
}

BondId System::Implementation::apply(const step::CreateBond& c) {
  const std::uint32_t p = require(c.p), q = require(c.q), slot = require(c.law);
  if (p == q) throw std::invalid_argument(text("a bond needs two particles, got particle ", p, " twice"));
  const model::Law& law = model.laws[slot];
  if (c.implicit && !law.has_derivative())
    throw std::invalid_argument(
        text("the law ", law.name.data(), " is code without a derivative: its bonds cannot be implicit"));
  model::Bond bond;
  bond.p = p, bond.q = q, bond.law = slot, bond.implicit = c.implicit, bond.script = c.script;
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    const double value = c.parameters[i];
    bond.parameters[i] = std::isnan(value) ? norm(model.position(q) - model.position(p)) : value;
    require_parameter_value(law, i, bond.parameters[i]);
  }
  structure_changed();
  return model.bonds.id(model.add_bond(bond));
}

void System::Implementation::apply(const step::SetParameter& c) {
  model::Bond& bond = model.bonds[require(c.bond)];
  model.scene.bonds.note(c.bond.slot);
  step::set_parameter(model.laws[bond.law], bond.parameters, c.index, c.value);
}

void System::Implementation::apply(const step::SetActive& c) {
  const std::uint32_t slot = require(c.bond);
  model::Bond& bond = model.bonds[slot];
  if (bond.active == static_cast<std::uint8_t>(c.active)) return;
  bond.active = c.active;
  bond.broken = 0;
  ++model.bonds_revision;
  for (const std::uint32_t end : {bond.p, bond.q}) model.touch_particle(end);
  structure_changed();
}

void System::Implementation::apply(const step::Destroy<BondId>& c) {
  const std::uint32_t bond = require(c.id);
  // A restore or a replay may bring the bond back, if it was made before the latest snapshot.
  if (!recording && model.bonds[bond].script >= scripts_saved_below) scripts.erase(model.bonds[bond].script);
  model.remove_bond(bond);
  structure_changed();
}

void System::Implementation::apply(const step::Destroy<LawId>& c) {
  const std::uint32_t slot = require(c.id);
  const model::Law& law = model.laws[slot];
  if (slot <= model::scripted_law) throw std::invalid_argument("a predefined law cannot be destroyed");
  if (law.uses > 0)
    throw std::invalid_argument(text("the law ", law.name.data(), " cannot be destroyed: ", law.uses,
                                     law.uses == 1 ? " bond has it" : " bonds have it", "; destroy those first"));
  if (!recording && law.function >= scripts_saved_below) law_functions.erase(law.function);
  model.laws.destroy(slot);
}

// --- System -----------------------------------------------------------------------------------------------------------

LawId System::create_law(LawBody body, const LawOptions& options) {
  Implementation& i = *implementation_;
  model::Law law = make_law(body, options);
  Implementation::LawFunction function;
  if (const auto* radial = std::get_if<RadialFunction>(&body)) function.radial = *radial;
  if (auto* batch = std::get_if<BatchFunction>(&body)) function.batch = std::move(*batch);
  if (!law.has_derivative()) {
    if (!function.radial && !function.batch) throw std::invalid_argument("a law needs a function, got none");
    law.function = i.next_script;
  }
  i.spell(&law, sizeof law);
  const LawId id = i.execute(step::CreateLaw{});
  if (!law.has_derivative()) i.law_functions[i.next_script++] = std::move(function);
  return id;
}

LawId System::find_law(std::string_view name) const {
  const std::uint32_t number = laws::find_pair_law(name);
  if (number < laws::pair_law_count) return implementation_->model.laws.id(number);
  const auto& made = implementation_->model.laws;
  LawId found;
  std::vector<std::string> known;
  made.for_each([&](std::uint32_t slot, const model::Law& law) {
    if (slot < laws::pair_law_count || law.kind == model::LawKind::scripted || law.name[0] == '\0') return;
    if (name == law.name.data()) found = made.id(slot);
    known.emplace_back(law.name.data());
  });
  if (found) return found;
  std::string list;
  for (std::uint32_t i = 0; i < laws::pair_law_count; ++i) {
    known.emplace_back(laws::pair_law_name(i));
    list += (i ? ", " : "") + known.back();
  }
  const std::string near = expression::nearest(name, known);
  throw std::invalid_argument(text("no law is called '", name, "'",
                                   near.empty() ? "." : "; did you mean '" + near + "'?", " Predefined are ", list,
                                   "; an expression says 'energy = ...' or 'force = ...'"));
}

BondId System::create_bond(ParticleId p, ParticleId q, BondLaw body) {
  Implementation& i = *implementation_;
  const auto law_id = [&](std::uint32_t slot) { return i.model.laws.id(slot); };
  step::CreateBond command{p, q, {}, true, 0, {}};
  if (const auto* spring = std::get_if<SpringLaw>(&body)) {
    command.law = law_id(model::spring_law);
    command.parameters = {spring->stiffness, spring->damping, spring->length};
  } else if (const auto* drag = std::get_if<DragLaw>(&body)) {
    command.law = law_id(model::drag_law);
    command.parameters = {drag->damping};
  } else if (auto* scripted = std::get_if<ScriptedLaw>(&body)) {
    if (!scripted->force) throw std::invalid_argument("a scripted bond needs a function");
    command.law = law_id(model::scripted_law), command.implicit = false, command.script = i.next_script;
    const BondId id = i.execute(command);
    i.scripts[i.next_script++] = std::move(*scripted);
    return id;
  } else {
    const SharedLaw& shared = std::get<SharedLaw>(body);
    const model::Law& law = i.model.laws[i.require(shared.law)];
    if (law.kind == model::LawKind::scripted)
      throw std::invalid_argument("a bond with a function of its own is made with a ScriptedLaw");
    command.law = shared.law, command.parameters = law.standard;
    command.implicit = shared.implicit.value_or(law.has_derivative());
    for (const LawParameter& parameter : shared.parameters)
      command.parameters[require_parameter(law, parameter.name)] = parameter.value;
  }
  return i.execute(command);
}

void System::destroy(LawId id) { implementation_->execute(step::Destroy<LawId>{id}); }
bool System::contains(LawId id) const { return implementation_->model.laws.contains(id); }

LawId System::law(BondId id) const {
  const model::Model& m = implementation_->model;
  return m.laws.id(m.bonds[implementation_->require(id)].law);
}
bool System::is_implicit(BondId id) const {
  return implementation_->model.bonds[implementation_->require(id)].implicit;
}

std::string System::name(LawId id) const {
  return implementation_->model.laws[implementation_->require(id)].name.data();
}

std::string_view System::kind(LawId id) const {
  constexpr std::string_view words[] = {"predefined", "expression", "function", "compiled", "arrays"};
  return words[static_cast<std::size_t>(implementation_->model.laws[implementation_->require(id)].kind)];
}
std::string System::expression(LawId id) const {
  return implementation_->model.laws[implementation_->require(id)].text.data();
}

std::vector<LawParameter> System::parameters(LawId id) const {
  const model::Law& law = implementation_->model.laws[implementation_->require(id)];
  return list_parameters(law, law.standard);
}
std::vector<LawParameter> System::parameters(BondId id) const {
  const model::Model& m = implementation_->model;
  const model::Bond& bond = m.bonds[implementation_->require(id)];
  return list_parameters(m.laws[bond.law], bond.parameters);
}

void System::set_parameter(BondId id, std::string_view name, double value) {
  const model::Model& m = implementation_->model;
  const std::uint32_t index = require_parameter(m.laws[m.bonds[implementation_->require(id)].law], name);
  implementation_->execute(step::SetParameter{id, index, value});
}

}  // namespace iota
