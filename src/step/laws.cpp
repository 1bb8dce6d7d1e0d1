// SPDX-License-Identifier: Apache-2.0
// Laws and the bonds that use them: making, changing, destroying; and what System says of them.
#include "step/checks.h"
#include "step/execute.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace iota {

using namespace step;

namespace {

static_assert(max_law_parameters == laws::max_parameters);

std::string parameter_name(const model::Law& law, std::uint32_t index) { return law.parameters[index].data(); }

/// Index of a parameter; throws with the names that there are.
std::uint32_t require_parameter(const model::Law& law, std::string_view name) {
  std::vector<std::string> known;
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    known.push_back(parameter_name(law, i));
    if (known.back() == name) return i;
  }
  std::string message = text("the law ", law.name.data(), " has no parameter '", name, "'");
  if (const std::string near = expression::nearest(name, known); !near.empty())
    message += "; did you mean '" + near + "'?";
  message += known.empty() ? "; it has none" : "; it has ";
  for (std::size_t i = 0; i < known.size(); ++i) message += (i ? ", " : "") + known[i];
  throw std::invalid_argument(message);
}

void require_parameter_value(const model::Law& law, std::uint32_t index, double value) {
  const std::string name = parameter_name(law, index);
  laws::Range range = laws::Range::any;
  if (law.kind == model::LawKind::listed) range = laws::pair_law_parameters(law.number)[index].range;
  if (range == laws::Range::positive) require_positive(name, value);
  if (range == laws::Range::not_negative) require_not_negative(name, value);
  if (!std::isfinite(value)) throw std::invalid_argument(text(name, " must be finite, got ", value));
}

template <std::size_t n>
void put(std::array<char, n>& out, std::string_view from, const char* what) {
  if (from.size() >= n)
    throw std::invalid_argument(text(what, " must be shorter than ", n, " bytes, got ", from.size()));
  if (from.find('\0') != std::string_view::npos)
    throw std::invalid_argument(text(what, " must not contain a null character"));
  std::copy(from.begin(), from.end(), out.begin());
}

bool is_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

model::Law make_law(const LawBody& body, const LawOptions& options) {
  model::Law law;
  put(law.name, options.name, "the name of a law");
  if (options.parameters.size() > law.parameters.size())
    throw std::invalid_argument(
        text("a law has at most ", law.parameters.size(), " parameters, got ", options.parameters.size()));
  for (const LawParameter& parameter : options.parameters) {
    if (!is_name(parameter.name))
      throw std::invalid_argument(text("'", parameter.name, "' cannot be a parameter's name: use letters and digits"));
    for (const char* const variable : laws::PairLaw::variables)
      if (parameter.name == variable)
        throw std::invalid_argument(text("'", parameter.name, "' cannot be a parameter's name: it is a variable"));
    for (std::uint32_t i = 0; i < law.parameter_count; ++i)
      if (parameter_name(law, i) == parameter.name)
        throw std::invalid_argument(text("parameter '", parameter.name, "' is given twice"));
    put(law.parameters[law.parameter_count], parameter.name, "the name of a parameter");
    law.standard[law.parameter_count++] = parameter.value;
  }
  if (const auto* expression = std::get_if<std::string>(&body)) {
    law.kind = model::LawKind::expression;
    put(law.text, *expression, "the text of a law");
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

void System::Implementation::apply(const step::SpellLaw& c) {
  if (spelled_law.size() >= sizeof(model::Law) + sizeof c.piece) spelled_law.clear();
  spelled_law.insert(spelled_law.end(), c.piece.begin(), c.piece.end());
}

LawId System::Implementation::apply(const step::CreateLaw&) {
  if (spelled_law.size() < sizeof(model::Law)) throw std::invalid_argument("the record of a law is cut short");
  model::Law law;
  std::memcpy(&law, spelled_law.data(), sizeof law);
  spelled_law.clear();
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
  const std::uint32_t slot = require(c.bond);
  model::Bond& bond = model.bonds[slot];
  const model::Law& law = model.laws[bond.law];
  if (c.index >= law.parameter_count) throw std::invalid_argument("set_parameter: no such parameter");
  require_parameter_value(law, c.index, c.value);
  const double before = model.bond_energy(slot);
  bond.parameters[c.index] = c.value;
  model.edit_energy += model.bond_energy(slot) - before;
}

void System::Implementation::apply(const step::SetActive& c) {
  const std::uint32_t slot = require(c.bond);
  model::Bond& bond = model.bonds[slot];
  if (bond.active == static_cast<std::uint8_t>(c.active)) return;
  const double before = model.bond_energy(slot);
  bond.active = c.active;
  ++model.bonds_revision;
  for (const std::uint32_t end : {bond.p, bond.q}) model.touch_particle(end);
  model.edit_energy += model.bond_energy(slot) - before;
}

void System::Implementation::apply(const step::Destroy<BondId>& c) {
  const std::uint32_t bond = require(c.id);
  const double before = model.bond_energy(bond);
  // A restore or a replay may bring the bond back, if it was made before the latest snapshot.
  if (!recording && model.bonds[bond].script >= scripts_saved_below) scripts.erase(model.bonds[bond].script);
  model.remove_bond(bond);
  model.edit_energy -= before;
  structure_changed();
}

void System::Implementation::apply(const step::Destroy<LawId>& c) {
  const std::uint32_t slot = require(c.id);
  const model::Law& law = model.laws[slot];
  if (slot <= model::scripted_law) throw std::invalid_argument("a predefined law cannot be destroyed");
  if (law.uses > 0)
    throw std::invalid_argument(
        text("the law ", law.name.data(), " cannot be destroyed: ", law.uses, " bonds have it; destroy those first"));
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
  const auto* bytes = reinterpret_cast<const std::byte*>(&law);
  for (std::size_t at = 0; at < sizeof law;) {
    step::SpellLaw spell{};
    const std::size_t size = std::min(spell.piece.size(), sizeof law - at);
    std::copy_n(bytes + at, size, spell.piece.begin());
    i.execute(spell);
    at += size;
  }
  const LawId id = i.execute(step::CreateLaw{});
  if (!law.has_derivative()) i.law_functions[i.next_script++] = std::move(function);
  return id;
}

LawId System::find_law(std::string_view name) const {
  const std::uint32_t number = laws::find_pair_law(name);
  if (number < laws::pair_law_count) return implementation_->model.laws.id(number);
  std::vector<std::string> known;
  std::string list;
  for (std::uint32_t i = 0; i < laws::pair_law_count; ++i) {
    known.emplace_back(laws::pair_law_name(i));
    list += (i ? ", " : "") + known.back();
  }
  const std::string near = expression::nearest(name, known);
  throw std::invalid_argument(text("no law is called '", name, "'",
                                   near.empty() ? "" : "; did you mean '" + near + "'?", " Predefined are ", list,
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

namespace {

std::vector<LawParameter> list_parameters(const model::Law& law, const std::array<double, max_law_parameters>& values) {
  std::vector<LawParameter> list;
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) list.push_back({parameter_name(law, i), values[i]});
  return list;
}

}  // namespace

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
