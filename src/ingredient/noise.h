// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

namespace iota::ingredient {

/// Whether a force on a mass would take 1e9 times `rest_after` to give it the speed `rest_speed`: the round-off of a script's
/// sums is no reason to stay awake. Without sleep only zero is.
inline bool is_noise(const Model& model, const Vec3& force, double mass) {
  constexpr double small = 1e-9;
  const double most = model.rest_after > 0 ? small * model.rest_speed / model.rest_after * std::abs(mass) : 0;
  return dot(force, force) <= most * most;
}

}  // namespace iota::ingredient
