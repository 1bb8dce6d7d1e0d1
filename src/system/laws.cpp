// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "system/core.h"

namespace iota {

std::size_t Laws::rehearse(LawId id, double dt) { return core_.held.rehearse_law(core_.slot(id), dt); }

LawId Laws::create(LawBody body, const LawOptions& options) {
  edit::CreateLaw command{ingredient::LawKind::expression, options.name, {}, options.parameters, 0};
  if (const auto* expression = std::get_if<std::string>(&body)) {
    command.text = *expression;
    return core_.execute(command);
  }
  held::Functions::Law function;
  if (const auto* radial = std::get_if<RadialFunction>(&body)) function.radial = *radial;
  if (auto* batch = std::get_if<BatchFunction>(&body)) function.batch = std::move(*batch);
  if (!function.radial && !function.batch) throw std::invalid_argument("a law needs a function, got none");
  held::Functions& functions = core_.held.functions;
  command.kind = function.radial ? ingredient::LawKind::radial : ingredient::LawKind::batch;
  command.function = functions.next_key;
  const LawId id = core_.execute(command);
  functions.of_laws[functions.next_key++] = std::move(function);
  return id;
}

LawId Laws::find(std::string_view name) const {
  const std::uint32_t number = laws::find_pair_law(name);
  if (number < laws::pair_law_count) return core_.model.laws.id(number);
  const auto& made = core_.model.laws;
  LawId found;
  std::vector<std::string> known;
  made.for_each([&](std::uint32_t slot, const ingredient::Law& law) {
    if (slot < laws::pair_law_count || law.kind == ingredient::LawKind::scripted || law.name[0] == '\0') return;
    if (name == law.name.data()) found = made.id(slot);
    known.emplace_back(law.name.data());
  });
  if (found) return found;
  std::string list;
  for (std::uint32_t i = 0; i < laws::pair_law_count; ++i) {
    known.emplace_back(laws::pair_law_name(i));
    list += (i ? ", " : "") + known.back();
  }
  const std::string near = expression::nearest(name, known);
  throw std::invalid_argument(text("no law is called '", name, "'",
                                   near.empty() ? "." : "; did you mean '" + near + "'?", " Predefined are ", list,
                                   "; an expression says 'energy = ...' or 'force = ...'"));
}

void Laws::destroy(LawId id) { core_.execute(edit::Destroy<LawId>{id}); }

bool Laws::contains(LawId id) const { return core_.model.laws.contains(id); }

std::string Laws::name(LawId id) const { return core_.model.laws[core_.slot(id)].name.data(); }

std::string_view Laws::kind(LawId id) const {
  constexpr std::string_view words[] = {"predefined", "expression", "function", "compiled", "arrays"};
  return words[static_cast<std::size_t>(core_.model.laws[core_.slot(id)].kind)];
}

std::string Laws::expression(LawId id) const { return core_.model.laws[core_.slot(id)].text.data(); }

std::vector<LawParameter> Laws::parameters(LawId id) const {
  const ingredient::Law& law = core_.model.laws[core_.slot(id)];
  return edit::list_parameters(law, law.standard);
}

}  // namespace iota
