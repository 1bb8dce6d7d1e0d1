// SPDX-License-Identifier: Apache-2.0
#include "edit/fields.h"

#include "edit/law_checks.h"
#include "math/checks.h"

#include <cmath>

namespace iota::edit {

// --- groups -----------------------------------------------------------------------------------------------------------

GroupId apply(Editor& e, const CreateGroup& c) {
  model::Model& model = e.model;
  if (c.name.empty()) throw std::invalid_argument("a group needs a name");
  if (model.groups.size() == static_cast<std::uint32_t>(max_groups))
    throw std::invalid_argument(text("a system has at most ", max_groups, " groups"));
  model::Group group;
  put_text(group.name, c.name, "the name of a group");
  model.groups.for_each([&](std::uint32_t, const model::Group& g) {
    if (g.name == group.name) throw std::invalid_argument(text("there is a group '", c.name, "' already"));
  });
  return model.groups.create(group);
}

void apply(Editor& e, const SetMember& c) {
  model::Model& model = e.model;
  const std::uint32_t bit = 1u << e.require(c.group);
  model::Particle& particle = model.particles[e.require(c.particle)];
  const bool may_matter = !model.ignored_contacts.empty();
  const auto belongs = [&] { return may_matter && ingredient::belongs(model, particle.body, {{}, c.group}); };
  const bool belonged = belongs();
  particle.groups = c.member ? particle.groups | bit : particle.groups & ~bit;
  ++model.members_revision;
  if (belongs() != belonged) ingredient::IgnoredContacts::change_member(model, particle.body, c.group);
}

std::optional<GroupId> group_at(const model::Model& model, std::uint32_t slot) {
  if (slot == model::none) return std::nullopt;
  return model.groups.id(slot);
}

void apply(Editor& e, const Destroy<GroupId>& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.id);
  const auto refuse = [&](const char* what, std::uint32_t user) {
    throw std::invalid_argument(text("the group ", model.groups[slot].name.data(), " cannot be destroyed: ", what, " ",
                                     user, " acts on it; destroy that first"));
  };
  model.fields.for_each([&](std::uint32_t f, const ingredient::Field& field) {
    if (field.group == slot) refuse("field", f);
  });
  model.pairs.for_each([&](std::uint32_t p, const ingredient::PairForce& pairs) {
    if (pairs.group == slot || pairs.other == slot) refuse("pairwise force", p);
  });
  ingredient::IgnoredContacts::forget_group(model, c.id);
  model.particles.for_each(
      [&](std::uint32_t p, const model::Particle&) { model.particles[p].groups &= ~(1u << slot); });
  model.groups.destroy(slot);
  ++model.members_revision;
}

// --- fields -----------------------------------------------------------------------------------------------------------

namespace {

laws::Range range_of(const ingredient::Field& field, std::uint32_t index) {
  return field.kind == ingredient::FieldKind::listed ? laws::field_law_parameters(field.number)[index].range
                                                     : laws::Range::any;
}

std::string list_of_fields() {
  std::string list;
  for (std::uint32_t i = 0; i < laws::field_law_count; ++i)
    list += (i ? ", " : "") + std::string(laws::field_law_name(i));
  return list;
}

ingredient::Field make_field(const CreateField& c) {
  ingredient::Field field;
  put_text(field.name, c.name, "the name of a field");
  if (c.function == 0 && c.text.find('=') == std::string::npos) {
    field.number = laws::find_field_law(c.text);
    if (field.number == laws::field_law_count)
      throw std::invalid_argument(text("no field is called '", c.text, "'. Predefined are ", list_of_fields(),
                                       "; an expression says 'fx = ...; fy = ...; fz = ...'"));
    if (c.name.empty()) put_text(field.name, c.text, "the name of a field");
    for (const laws::Parameter& p : laws::field_law_parameters(field.number)) {
      put_text(field.names[field.parameter_count], p.name, "the name of a parameter");
      field.parameters[field.parameter_count++] = p.standard;
    }
    for (const LawParameter& p : c.parameters)
      field.parameters[require_parameter(field.name.data(), field.names, field.parameter_count, p.name)] = p.value;
  } else {
    put_parameters(field.names, field.parameters, field.parameter_count, c.parameters, laws::FieldLaw::variables);
    field.kind = c.function == 0 ? ingredient::FieldKind::expression : ingredient::FieldKind::function;
    field.function = c.function;
    put_text(field.text, c.text, "the text of a field");
  }
  for (std::uint32_t i = 0; i < field.parameter_count; ++i)
    require_in_range(field.names[i].data(), range_of(field, i), field.parameters[i]);
  field.replaces_gravity = c.replaces_gravity;
  return field;
}

}  // namespace

FieldId apply(Editor& e, const CreateField& c) {
  model::Model& model = e.model;
  ingredient::Field field = make_field(c);
  field.group = c.group ? e.require(c.group) : model::none;
  return model.fields.id(model.make_field(field));
}

void apply(Editor& e, const SetFieldParameter& c) {
  ingredient::Field& field = e.model.fields[e.require(c.field)];
  if (c.index >= field.parameter_count) throw std::invalid_argument("set_parameter: no such parameter");
  require_in_range(field.names[c.index].data(), range_of(field, c.index), c.value);
  field.parameters[c.index] = c.value;
}

void apply(Editor& e, const SetFieldActive& c) { e.model.fields[e.require(c.field)].active = c.active; }

void apply(Editor& e, const Destroy<FieldId>& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.id);
  e.drop_function(e.held.functions.of_fields, model.fields[slot].function);
  model.fields.destroy(slot);
}

// --- pairwise forces --------------------------------------------------------------------------------------------------

PairsId apply(Editor& e, const CreatePairs& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.law);
  const ingredient::Law& law = model.laws[slot];
  require_positive("cutoff", c.cutoff);
  if (!law.has_derivative())
    throw std::invalid_argument(text("pairwise forces take a predefined law or an expression, not the law ", slot));
  ingredient::PairForce pairs;
  pairs.law = slot, pairs.cutoff = c.cutoff, pairs.group = c.group ? e.require(c.group) : model::none;
  pairs.other = c.other ? e.require(c.other) : model::none;
  if (c.other && !c.group) throw std::invalid_argument("pairs between two groups need both: give group and other");
  const laws::PairLaw& compiled = model.compiled(slot);
  if (c.shifted && (!compiled.has_energy() || compiled.depends_on_mass() || compiled.depends_on_normals()))
    throw std::invalid_argument(text("the law ", law.name.data(),
                                     " cannot be shifted: that needs an energy that depends on the distance alone"));
  pairs.shifted = c.shifted;
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    if (std::isnan(c.parameters[i]))
      throw std::invalid_argument(text("pairwise forces need a value for ", law.parameters[i].data()));
    require_parameter_value(law, i, c.parameters[i]);
  }
  pairs.parameters = c.parameters;
  ++model.laws[slot].uses;
  return model.pairs.create(pairs);
}

void apply(Editor& e, const SetPairsParameter& c) {
  model::Model& model = e.model;
  ingredient::PairForce& pairs = model.pairs[e.require(c.pairs)];
  set_parameter(model.laws[pairs.law], pairs.parameters, c.index, c.value);
}

void apply(Editor& e, const SetPairsActive& c) { e.model.pairs[e.require(c.pairs)].active = c.active; }

void apply(Editor& e, const Destroy<PairsId>& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.id);
  --model.laws[model.pairs[slot].law].uses;
  model.pairs.destroy(slot);
}

}  // namespace iota::edit
