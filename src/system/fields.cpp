// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

FieldId Fields::create(FieldBody body, const FieldOptions& options) {
  edit::CreateField command{
      options.name, {}, options.parameters, options.group.value_or(GroupId{}), options.replaces_gravity, 0};
  if (const auto* text = std::get_if<std::string>(&body)) {
    command.text = *text;
    return core_.execute(command);
  }
  auto& function = std::get<FieldFunction>(body);
  if (!function) throw std::invalid_argument("a field needs a function, got none");
  held::Functions& functions = core_.held.functions;
  command.function = functions.next_key;
  const FieldId id = core_.execute(command);
  functions.of_fields[functions.next_key++] = std::move(function);
  return id;
}

void Fields::destroy(FieldId id) { core_.execute(edit::Destroy<FieldId>{id}); }

bool Fields::contains(FieldId id) const { return core_.model.fields.contains(id); }

bool Fields::is_active(FieldId id) const { return core_.model.fields[core_.slot(id)].active; }

void Fields::set_active(FieldId id, bool active) { core_.execute(edit::SetFieldActive{id, active}); }

std::string Fields::name(FieldId id) const { return core_.model.fields[core_.slot(id)].name.data(); }

std::string_view Fields::kind(FieldId id) const {
  constexpr std::string_view words[] = {"predefined", "expression", "function"};
  return words[static_cast<std::size_t>(core_.model.fields[core_.slot(id)].kind)];
}

std::string Fields::text(FieldId id) const {
  const ingredient::Field& field = core_.model.fields[core_.slot(id)];
  return field.kind == ingredient::FieldKind::listed ? laws::field_law_name(field.number) : field.text.data();
}

std::optional<GroupId> Fields::group(FieldId id) const {
  return edit::group_at(core_.model, core_.model.fields[core_.slot(id)].group);
}

bool Fields::replaces_gravity(FieldId id) const { return core_.model.fields[core_.slot(id)].replaces_gravity != 0; }

std::vector<LawParameter> Fields::parameters(FieldId id) const {
  const ingredient::Field& field = core_.model.fields[core_.slot(id)];
  return edit::list_parameters(field.names, field.parameter_count, field.parameters.data());
}

void Fields::set_parameter(FieldId id, std::string_view name, double value) {
  const ingredient::Field& field = core_.model.fields[core_.slot(id)];
  const std::uint32_t index = edit::require_parameter(field.name.data(), field.names, field.parameter_count, name);
  core_.execute(edit::SetFieldParameter{id, index, value});
}

std::vector<FieldId> Fields::ids() const { return core_.model.fields.ids(); }

std::size_t Fields::rehearse(FieldId id, double dt) { return core_.held.rehearse_field(core_.slot(id), dt); }

}  // namespace iota
