// SPDX-License-Identifier: Apache-2.0
// The table of laws, and the laws made ready from it.
#include "model/model.h"

#include <cstring>

namespace iota::model {

namespace {

template <std::size_t n>
void put(std::array<char, n>& out, const char* text) {
  std::strncpy(out.data(), text, n - 1);
}

}  // namespace

Model::Model() {
  for (std::uint32_t number = 0; number < laws::pair_law_count; ++number) {
    Law law;
    law.number = number;
    put(law.name, laws::pair_law_name(number));
    put(law.text, laws::pair_law_text(number));
    for (const laws::Parameter& parameter : laws::pair_law_parameters(number)) {
      put(law.parameters[law.parameter_count], parameter.name);
      law.standard[law.parameter_count++] = parameter.standard;
    }
    make_law(law);
  }
  Law scripted;
  scripted.kind = LawKind::scripted;
  put(scripted.name, "function");
  make_law(scripted);
}

std::uint32_t Model::make_law(const Law& law) {
  const std::uint32_t slot = laws.create(law).slot;
  try {
    compile_law(slot);
  } catch (...) {
    laws.destroy(slot);
    throw;
  }
  return slot;
}

void Model::compile_law(std::uint32_t slot) {
  if (compiled_laws_.size() <= slot) compiled_laws_.resize(slot + 1);
  const Law& law = laws[slot];
  compiled_laws_[slot].reset();
  if (law.kind == LawKind::listed) {
    compiled_laws_[slot] = std::make_shared<const laws::PairLaw>(law.number);
  } else if (law.kind == LawKind::expression) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < law.parameter_count; ++i) names.emplace_back(law.parameters[i].data());
    compiled_laws_[slot] = std::make_shared<const laws::PairLaw>(law.text.data(), std::move(names));
  }
}

std::uint32_t Model::make_field(const Field& field) {
  const std::uint32_t slot = fields.create(field).slot;
  try {
    compile_field(slot);
  } catch (...) {
    fields.destroy(slot);
    throw;
  }
  return slot;
}

void Model::compile_field(std::uint32_t slot) {
  if (compiled_fields_.size() <= slot) compiled_fields_.resize(slot + 1);
  const Field& field = fields[slot];
  compiled_fields_[slot].reset();
  if (field.kind == FieldKind::listed) {
    compiled_fields_[slot] = std::make_shared<const laws::FieldLaw>(field.number);
  } else if (field.kind == FieldKind::expression) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < field.parameter_count; ++i) names.emplace_back(field.names[i].data());
    compiled_fields_[slot] = std::make_shared<const laws::FieldLaw>(field.text.data(), std::move(names));
  }
}

Vec3 Model::acting_gravity() const {
  bool replaced = false;
  fields.for_each([&](std::uint32_t, const Field& f) { replaced = replaced || (f.active && f.replaces_gravity); });
  return replaced ? Vec3{} : gravity;
}

void Model::compile_laws() {
  compiled_laws_.clear();
  laws.for_each([&](std::uint32_t slot, const Law&) { compile_law(slot); });
}

void Model::compile_fields() {
  compiled_fields_.clear();
  fields.for_each([&](std::uint32_t slot, const Field&) { compile_field(slot); });
}

}  // namespace iota::model
