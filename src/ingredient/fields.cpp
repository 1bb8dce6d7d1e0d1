// SPDX-License-Identifier: Apache-2.0
#include "ingredient/fields.h"

#include "ingredient/compiled.h"
#include "ingredient/model.h"

namespace iota::ingredient {

namespace {

/// Bytes may contain any value.
bool is_field(const Field& field) {
  return field.kind <= FieldKind::function &&
         (field.kind != FieldKind::listed || field.number < laws::field_law_count) &&
         field.parameter_count <= field.parameters.size() && has_end(field.name) && has_end(field.text) &&
         std::all_of(field.names.begin(), field.names.end(), [](const auto& name) { return has_end(name); });
}

}  // namespace

void Fields::validate(const Model& model, model::Audit& audit) {
  model.fields.for_each([&](std::uint32_t slot, const Field& f) { audit.require_group("field", slot, f.group); });
}

std::uint32_t Fields::Tables::make_field(const Field& field) {
  return create_compiled(fields, field, [&](std::uint32_t slot) { compile(slot); });
}

void Fields::Tables::compile(std::uint32_t slot) {
  if (compiled_.size() <= slot) compiled_.resize(slot + 1);
  const Field& field = fields[slot];
  compiled_[slot].reset();
  if (field.kind == FieldKind::listed) {
    compiled_[slot] = std::make_shared<const laws::FieldLaw>(field.number);
  } else if (field.kind == FieldKind::expression) {
    compiled_[slot] =
        std::make_shared<const laws::FieldLaw>(field.text.data(), names_of(field.names, field.parameter_count));
  }
}

bool Fields::Tables::compile() {
  compiled_.clear();
  return compile_all(fields, is_field, [&](std::uint32_t slot) { compile(slot); });
}

bool Fields::replaces_gravity(const Model& model) {
  bool replaced = false;
  model.fields.for_each(
      [&](std::uint32_t, const Field& f) { replaced = replaced || (f.active && f.replaces_gravity); });
  return replaced;
}

}  // namespace iota::ingredient
