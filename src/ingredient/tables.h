// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <string>
#include <vector>

namespace iota::ingredient {

/// Errors of a model; empty: none.
std::vector<std::string> validate(const model::Model&);

}  // namespace iota::ingredient
