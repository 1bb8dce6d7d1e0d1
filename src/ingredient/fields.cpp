// SPDX-License-Identifier: Apache-2.0
#include "ingredient/fields.h"

#include "ingredient/model.h"
namespace iota::ingredient {

namespace {

template <std::size_t n>
bool has_end(const std::array<char, n>& text) {
  return std::find(text.begin(), text.end(), '\0') != text.end();
}

/// Bytes may hold anything.
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
  const std::uint32_t slot = fields.create(field).slot;
  try {
    compile(slot);
  } catch (...) {
    fields.destroy(slot);
    throw;
  }
  return slot;
}

void Fields::Tables::compile(std::uint32_t slot) {
  if (compiled_.size() <= slot) compiled_.resize(slot + 1);
  const Field& field = fields[slot];
  compiled_[slot].reset();
  if (field.kind == FieldKind::listed) {
    compiled_[slot] = std::make_shared<const laws::FieldLaw>(field.number);
  } else if (field.kind == FieldKind::expression) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < field.parameter_count; ++i) names.emplace_back(field.names[i].data());
    compiled_[slot] = std::make_shared<const laws::FieldLaw>(field.text.data(), std::move(names));
  }
}

bool Fields::Tables::compile() {
  compiled_.clear();
  bool good = true;
  fields.for_each([&](std::uint32_t slot, const Field& field) {
    good = good && is_field(field);
    if (!good) return;
    try {
      compile(slot);
    } catch (const expression::ExpressionError&) {
      good = false;
    }
  });
  return good;
}

bool Fields::replaces_gravity(const Model& model) {
  bool replaced = false;
  model.fields.for_each(
      [&](std::uint32_t, const Field& f) { replaced = replaced || (f.active && f.replaces_gravity); });
  return replaced;
}

}  // namespace iota::ingredient
