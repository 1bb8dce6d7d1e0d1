// SPDX-License-Identifier: Apache-2.0
#include "ingredient/laws.h"

#include "ingredient/model.h"

#include <algorithm>
#include <cstring>

namespace iota::ingredient {

namespace {

template <std::size_t n>
void put(std::array<char, n>& out, const char* text) {
  std::strncpy(out.data(), text, n - 1);
}

template <std::size_t n>
bool has_end(const std::array<char, n>& text) {
  return std::find(text.begin(), text.end(), '\0') != text.end();
}

/// Bytes may hold anything.
bool is_law(const Law& law) {
  return law.kind <= LawKind::batch && (law.kind != LawKind::listed || law.number < laws::pair_law_count) &&
         law.parameter_count <= law.parameters.size() && has_end(law.name) && has_end(law.text) &&
         std::all_of(law.parameters.begin(), law.parameters.end(), [](const auto& name) { return has_end(name); });
}

}  // namespace

Laws::Tables::Tables() {
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

std::uint32_t Laws::Tables::make_law(const Law& law) {
  const std::uint32_t slot = laws.create(law).slot;
  try {
    compile(slot);
  } catch (...) {
    laws.destroy(slot);
    throw;
  }
  return slot;
}

void Laws::Tables::compile(std::uint32_t slot) {
  if (compiled_.size() <= slot) compiled_.resize(slot + 1);
  const Law& law = laws[slot];
  compiled_[slot].reset();
  if (law.kind == LawKind::listed) {
    compiled_[slot] = std::make_shared<const laws::PairLaw>(law.number);
  } else if (law.kind == LawKind::expression) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < law.parameter_count; ++i) names.emplace_back(law.parameters[i].data());
    compiled_[slot] = std::make_shared<const laws::PairLaw>(law.text.data(), std::move(names));
  }
}

bool Laws::Tables::compile() {
  compiled_.clear();
  bool good = true;
  laws.for_each([&](std::uint32_t slot, const Law& law) {
    good = good && is_law(law);
    if (!good) return;
    try {
      compile(slot);
    } catch (const expression::ExpressionError&) {
      good = false;
    }
  });
  return good;
}

void Laws::validate(const Model& model, model::Audit& audit) {
  model.laws.for_each([&](std::uint32_t slot, const Law& law) { audit.require_uses("law", slot, law.uses); });
}

}  // namespace iota::ingredient
