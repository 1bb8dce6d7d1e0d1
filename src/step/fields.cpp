// SPDX-License-Identifier: Apache-2.0
// Groups of particles, fields and pairwise forces: making, changing, destroying; and what System says of them.
#include "step/checks.h"
#include "step/execute.h"
#include "step/law_checks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace iota {

using namespace step;

namespace {

static_assert(max_field_parameters == laws::max_field_parameters);

laws::Range range_of(const model::Field& field, std::uint32_t index) {
  return field.kind == model::FieldKind::listed ? laws::field_law_parameters(field.number)[index].range
                                                : laws::Range::any;
}

std::string list_of_fields() {
  std::string list;
  for (std::uint32_t i = 0; i < laws::field_law_count; ++i)
    list += (i ? ", " : "") + std::string(laws::field_law_name(i));
  return list;
}

model::Field make_field(const FieldBody& body, const FieldOptions& options) {
  model::Field field;
  put_text(field.name, options.name, "the name of a field");
  if (const auto* text = std::get_if<std::string>(&body); text && text->find('=') == std::string::npos) {
    field.number = laws::find_field_law(*text);
    if (field.number == laws::field_law_count)
      throw std::invalid_argument(step::text("no field is called '", *text, "'. Predefined are ", list_of_fields(),
                                             "; an expression says 'fx = ...; fy = ...; fz = ...'"));
    if (options.name.empty()) put_text(field.name, *text, "the name of a field");
    for (const laws::Parameter& p : laws::field_law_parameters(field.number)) {
      put_text(field.names[field.parameter_count], p.name, "the name of a parameter");
      field.parameters[field.parameter_count++] = p.standard;
    }
    for (const LawParameter& p : options.parameters)
      field.parameters[require_parameter(field.name.data(), field.names, field.parameter_count, p.name)] = p.value;
  } else {
    put_parameters(field.names, field.parameters, field.parameter_count, options.parameters, laws::FieldLaw::variables);
    field.kind = text ? model::FieldKind::expression : model::FieldKind::function;
    if (text) put_text(field.text, *text, "the text of a field");
  }
  field.replaces_gravity = options.replaces_gravity;
  return field;
}

}  // namespace

std::uint32_t System::Implementation::require(GroupId id) const {
  if (!model.groups.contains(id)) throw_stale("group", id, std::optional<GroupId>{});
  return id.slot;
}
std::uint32_t System::Implementation::require(FieldId id) const {
  if (!model.fields.contains(id)) throw_stale("field", id, std::optional<FieldId>{});
  return id.slot;
}
std::uint32_t System::Implementation::require(PairsId id) const {
  if (!model.pairs.contains(id)) throw_stale("pairwise force", id, std::optional<PairsId>{});
  return id.slot;
}

// --- groups -----------------------------------------------------------------------------------------------------------

GroupId System::Implementation::apply(const step::CreateGroup& c) {
  if (model.groups.size() == static_cast<std::uint32_t>(max_groups))
    throw std::invalid_argument(text("a system has at most ", max_groups, " groups"));
  model::Group group{c.name};
  group.name.back() = '\0';
  model.groups.for_each([&](std::uint32_t, const model::Group& g) {
    if (std::strcmp(g.name.data(), group.name.data()) == 0)
      throw std::invalid_argument(text("there is a group '", group.name.data(), "' already"));
  });
  return model.groups.create(group);
}

void System::Implementation::apply(const step::SetMember& c) {
  const std::uint32_t bit = 1u << require(c.group);
  std::uint32_t& groups = model.particles[require(c.particle)].groups;
  groups = c.member ? groups | bit : groups & ~bit;
  ++model.members_revision;
}

void System::Implementation::apply(const step::Destroy<GroupId>& c) {
  const std::uint32_t slot = require(c.id);
  const auto refuse = [&](const char* what, std::uint32_t user) {
    throw std::invalid_argument(text("the group ", model.groups[slot].name.data(), " cannot be destroyed: ", what, " ",
                                     user, " acts on it; destroy that first"));
  };
  model.fields.for_each([&](std::uint32_t f, const model::Field& field) {
    if (field.group == slot) refuse("field", f);
  });
  model.pairs.for_each([&](std::uint32_t p, const model::Pairs& pairs) {
    if (pairs.group == slot) refuse("pairwise force", p);
  });
  model.particles.for_each(
      [&](std::uint32_t p, const model::Particle&) { model.particles[p].groups &= ~(1u << slot); });
  model.groups.destroy(slot);
  ++model.members_revision;
}

// --- fields -----------------------------------------------------------------------------------------------------------

FieldId System::Implementation::apply(const step::CreateField& c) {
  if (spelled.size() < sizeof(model::Field)) throw std::invalid_argument("the record of a field is cut short");
  model::Field field;
  std::memcpy(&field, spelled.data(), sizeof field);
  spelled.clear();
  if (field.kind > model::FieldKind::function || field.parameter_count > field.parameters.size() ||
      (field.kind == model::FieldKind::listed && field.number >= laws::field_law_count))
    throw std::invalid_argument("the record of a field is damaged");
  field.name.back() = field.text.back() = '\0';
  for (auto& name : field.names) name.back() = '\0';
  for (std::uint32_t i = 0; i < field.parameter_count; ++i)
    require_in_range(field.names[i].data(), range_of(field, i), field.parameters[i]);
  field.group = c.group ? require(c.group) : model::none;
  return model.fields.id(model.make_field(field));
}

void System::Implementation::apply(const step::SetFieldParameter& c) {
  model::Field& field = model.fields[require(c.field)];
  if (c.index >= field.parameter_count) throw std::invalid_argument("set_parameter: no such parameter");
  require_in_range(field.names[c.index].data(), range_of(field, c.index), c.value);
  field.parameters[c.index] = c.value;
}

void System::Implementation::apply(const step::SetFieldActive& c) { model.fields[require(c.field)].active = c.active; }

void System::Implementation::apply(const step::Destroy<FieldId>& c) {
  const std::uint32_t slot = require(c.id);
  const std::uint64_t function = model.fields[slot].function;
  if (!recording && function >= scripts_saved_below) field_functions.erase(function);
  model.fields.destroy(slot);
}

// --- pairs ------------------------------------------------------------------------------------------------------------

PairsId System::Implementation::apply(const step::CreatePairs& c) {
  const std::uint32_t slot = require(c.law);
  const model::Law& law = model.laws[slot];
  require_positive("cutoff", c.cutoff);
  if (!law.has_derivative())
    throw std::invalid_argument(text("pairwise forces take a predefined law or an expression, not the law ", slot));
  model::Pairs pairs;
  pairs.law = slot, pairs.cutoff = c.cutoff, pairs.group = c.group ? require(c.group) : model::none;
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    if (std::isnan(c.parameters[i]))
      throw std::invalid_argument(text("pairwise forces need a value for ", law.parameters[i].data()));
    require_parameter_value(law, i, c.parameters[i]);
  }
  pairs.parameters = c.parameters;
  ++model.laws[slot].uses;
  return model.pairs.create(pairs);
}

void System::Implementation::apply(const step::SetPairsParameter& c) {
  model::Pairs& pairs = model.pairs[require(c.pairs)];
  step::set_parameter(model.laws[pairs.law], pairs.parameters, c.index, c.value);
}

void System::Implementation::apply(const step::SetPairsActive& c) { model.pairs[require(c.pairs)].active = c.active; }

void System::Implementation::apply(const step::Destroy<PairsId>& c) {
  const std::uint32_t slot = require(c.id);
  --model.laws[model.pairs[slot].law].uses;
  model.pairs.destroy(slot);
}

// --- System -----------------------------------------------------------------------------------------------------------

GroupId System::create_group(std::string_view name) {
  step::CreateGroup command{};
  put_text(command.name, name, "the name of a group");
  if (name.empty()) throw std::invalid_argument("a group needs a name");
  return implementation_->execute(command);
}
void System::add(GroupId group, ParticleId particle) {
  implementation_->execute(step::SetMember{group, particle, true});
}
void System::remove(GroupId group, ParticleId particle) {
  implementation_->execute(step::SetMember{group, particle, false});
}
void System::destroy(GroupId id) { implementation_->execute(step::Destroy<GroupId>{id}); }
bool System::contains(GroupId id) const { return implementation_->model.groups.contains(id); }
bool System::contains(GroupId group, ParticleId particle) const {
  const std::uint32_t bit = 1u << implementation_->require(group);
  return implementation_->model.particles[implementation_->require(particle)].groups & bit;
}
std::string System::name(GroupId id) const {
  return implementation_->model.groups[implementation_->require(id)].name.data();
}
std::vector<GroupId> System::groups() const { return implementation_->model.groups.ids(); }
std::vector<ParticleId> System::particles(GroupId group) const {
  const std::uint32_t bit = 1u << implementation_->require(group);
  std::vector<ParticleId> list;
  implementation_->model.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
    if (p.groups & bit) list.push_back(implementation_->model.particles.id(slot));
  });
  return list;
}

FieldId System::create_field(FieldBody body, const FieldOptions& options) {
  Implementation& i = *implementation_;
  model::Field field = make_field(body, options);
  auto* const function = std::get_if<FieldFunction>(&body);
  if (function && !*function) throw std::invalid_argument("a field needs a function, got none");
  if (function) field.function = i.next_script;
  i.spell(&field, sizeof field);
  const FieldId id = i.execute(step::CreateField{options.group.value_or(GroupId{})});
  if (function) i.field_functions[i.next_script++] = std::move(*function);
  return id;
}
void System::destroy(FieldId id) { implementation_->execute(step::Destroy<FieldId>{id}); }
bool System::contains(FieldId id) const { return implementation_->model.fields.contains(id); }
bool System::is_active(FieldId id) const { return implementation_->model.fields[implementation_->require(id)].active; }
void System::set_active(FieldId id, bool active) { implementation_->execute(step::SetFieldActive{id, active}); }
std::string System::name(FieldId id) const {
  return implementation_->model.fields[implementation_->require(id)].name.data();
}
std::vector<LawParameter> System::parameters(FieldId id) const {
  const model::Field& field = implementation_->model.fields[implementation_->require(id)];
  return list_parameters(field.names, field.parameter_count, field.parameters.data());
}
void System::set_parameter(FieldId id, std::string_view name, double value) {
  const model::Field& field = implementation_->model.fields[implementation_->require(id)];
  const std::uint32_t index = require_parameter(field.name.data(), field.names, field.parameter_count, name);
  implementation_->execute(step::SetFieldParameter{id, index, value});
}
std::vector<FieldId> System::fields() const { return implementation_->model.fields.ids(); }

PairsId System::create_pairs(const SharedLaw& shared, const PairsOptions& options) {
  const model::Law& law = implementation_->model.laws[implementation_->require(shared.law)];
  if (shared.implicit.value_or(false))
    throw std::invalid_argument("pairwise forces are taken once a step and held: they cannot be implicit");
  step::CreatePairs command{shared.law, options.group.value_or(GroupId{}), options.cutoff, law.standard};
  for (const LawParameter& p : shared.parameters) command.parameters[require_parameter(law, p.name)] = p.value;
  return implementation_->execute(command);
}
void System::destroy(PairsId id) { implementation_->execute(step::Destroy<PairsId>{id}); }
bool System::contains(PairsId id) const { return implementation_->model.pairs.contains(id); }
bool System::is_active(PairsId id) const { return implementation_->model.pairs[implementation_->require(id)].active; }
void System::set_active(PairsId id, bool active) { implementation_->execute(step::SetPairsActive{id, active}); }
LawId System::law(PairsId id) const {
  const model::Model& m = implementation_->model;
  return m.laws.id(m.pairs[implementation_->require(id)].law);
}
double System::cutoff(PairsId id) const { return implementation_->model.pairs[implementation_->require(id)].cutoff; }
std::vector<LawParameter> System::parameters(PairsId id) const {
  const model::Model& m = implementation_->model;
  const model::Pairs& pairs = m.pairs[implementation_->require(id)];
  return list_parameters(m.laws[pairs.law], pairs.parameters);
}
void System::set_parameter(PairsId id, std::string_view name, double value) {
  const model::Model& m = implementation_->model;
  const std::uint32_t index = require_parameter(m.laws[m.pairs[implementation_->require(id)].law], name);
  implementation_->execute(step::SetPairsParameter{id, index, value});
}
std::vector<PairsId> System::all_pairs() const { return implementation_->model.pairs.ids(); }
double System::energy(PairsId id) const { return implementation_->pairs_energy(implementation_->require(id)); }

}  // namespace iota
