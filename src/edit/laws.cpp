// SPDX-License-Identifier: Apache-2.0
#include "edit/laws.h"

#include "edit/law_checks.h"

#include <cmath>

namespace iota::edit {

LawId apply(Editor& e, const CreateLaw& c) {
  model::Model& model = e.model;
  if (c.kind == ingredient::LawKind::listed || c.kind == ingredient::LawKind::scripted)
    throw std::invalid_argument("only laws that are expressions or code can be created");
  ingredient::Law law;
  law.kind = c.kind;
  put_text(law.name, c.name, "the name of a law");
  put_parameters(law.parameters, law.standard, law.parameter_count, c.parameters, laws::PairLaw::variables);
  for (std::uint32_t i = 0; i < law.parameter_count; ++i)
    if (!std::isnan(law.standard[i])) require_parameter_value(law, i, law.standard[i]);
  if (law.has_derivative())
    put_text(law.text, c.text, "the text of a law");
  else
    law.function = c.function;
  return model.laws.id(model.make_law(law));
}

void apply(Editor& e, const Destroy<LawId>& c) {
  model::Model& model = e.model;
  const std::uint32_t slot = e.require(c.id);
  const ingredient::Law& law = model.laws[slot];
  if (slot <= ingredient::scripted_law) throw std::invalid_argument("a predefined law cannot be destroyed");
  if (law.uses > 0)
    throw std::invalid_argument(
        text("the law ", law.name.data(), " cannot be destroyed: ", law.uses,
             law.uses == 1 ? " bond or pairwise force has it" : " bonds or pairwise forces have it",
             "; destroy those first"));
  e.drop_function(e.held.functions.of_laws, law.function);
  model.laws.destroy(slot);
}

}  // namespace iota::edit
