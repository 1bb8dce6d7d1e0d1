// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota {

template <>
struct LastEnumerator<ingredient::LawKind> : std::integral_constant<ingredient::LawKind, ingredient::LawKind::batch> {};

}  // namespace iota

namespace iota::edit {

struct CreateLaw {
  ingredient::LawKind kind;  ///< expression, radial or batch
  std::string name, text;
  std::vector<LawParameter> parameters;
  std::uint64_t function;  ///< key of the function, if it is code
};

LawId apply(Editor&, const CreateLaw&);
void apply(Editor&, const Destroy<LawId>&);

}  // namespace iota::edit
