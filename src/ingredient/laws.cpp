// SPDX-License-Identifier: Apache-2.0
#include "ingredient/laws.h"

#include "ingredient/compiled.h"
#include "ingredient/model.h"

#include <algorithm>
#include <cstring>

namespace iota::ingredient {

namespace {

template <std::size_t n>
void put(std::array<char, n>& out, const char* text) {
  std::strncpy(out.data(), text, n - 1);
}

/// Bytes may contain any value.
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
  return create_compiled(laws, law, [&](std::uint32_t slot) { compile(slot); });
}

void Laws::Tables::compile(std::uint32_t slot) {
  if (compiled_.size() <= slot) compiled_.resize(slot + 1);
  const Law& law = laws[slot];
  compiled_[slot].reset();
  if (law.kind == LawKind::listed) {
    compiled_[slot] = std::make_shared<const laws::PairLaw>(law.number);
  } else if (law.kind == LawKind::expression) {
    compiled_[slot] =
        std::make_shared<const laws::PairLaw>(law.text.data(), names_of(law.parameters, law.parameter_count));
  }
}

bool Laws::Tables::compile() {
  compiled_.clear();
  return compile_all(laws, is_law, [&](std::uint32_t slot) { compile(slot); });
}

void Laws::validate(const Model& model, model::Audit& audit) {
  model.laws.for_each([&](std::uint32_t slot, const Law& law) { audit.require_uses("law", slot, law.uses); });
}

}  // namespace iota::ingredient
