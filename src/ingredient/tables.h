// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <string>
#include <vector>

namespace iota::ingredient {

/// What is wrong with a model; empty: nothing.
std::vector<std::string> validate(const model::Model&);

}  // namespace iota::ingredient
