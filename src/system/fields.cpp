// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

FieldId System::create_field(FieldBody body, const FieldOptions& options) {
  Core& core = *implementation_;
  edit::CreateField command{
      options.name, {}, options.parameters, options.group.value_or(GroupId{}), options.replaces_gravity, 0};
  if (const auto* text = std::get_if<std::string>(&body)) {
    command.text = *text;
    return core.execute(command);
  }
  auto& function = std::get<FieldFunction>(body);
  if (!function) throw std::invalid_argument("a field needs a function, got none");
  held::Functions& functions = core.held.functions;
  command.function = functions.next_key;
  const FieldId id = core.execute(command);
  functions.of_fields[functions.next_key++] = std::move(function);
  return id;
}

void System::destroy(FieldId id) { implementation_->execute(edit::Destroy<FieldId>{id}); }

bool System::contains(FieldId id) const { return implementation_->model.fields.contains(id); }

bool System::is_active(FieldId id) const { return implementation_->model.fields[implementation_->slot(id)].active; }

void System::set_active(FieldId id, bool active) { implementation_->execute(edit::SetFieldActive{id, active}); }

std::string System::name(FieldId id) const {
  return implementation_->model.fields[implementation_->slot(id)].name.data();
}

std::vector<LawParameter> System::parameters(FieldId id) const {
  const model::Field& field = implementation_->model.fields[implementation_->slot(id)];
  return edit::list_parameters(field.names, field.parameter_count, field.parameters.data());
}

void System::set_parameter(FieldId id, std::string_view name, double value) {
  const model::Field& field = implementation_->model.fields[implementation_->slot(id)];
  const std::uint32_t index = edit::require_parameter(field.name.data(), field.names, field.parameter_count, name);
  implementation_->execute(edit::SetFieldParameter{id, index, value});
}

std::vector<FieldId> System::fields() const { return implementation_->model.fields.ids(); }

std::size_t System::rehearse(FieldId id, double dt) {
  return implementation_->held.rehearse_field(implementation_->slot(id), dt);
}

}  // namespace iota
