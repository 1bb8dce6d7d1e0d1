// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/loads.h"
#include "ingredient/model.h"

#include <vector>

namespace iota::ingredient {

/// The loads that one ingredient tells of a body.
template <class I>
struct CollectedLoads final : LoadReader {
  CollectedLoads(const model::Model& model, std::uint32_t body) {
    I::add_loads(LastStep(model, model.bodies[body].first), body, *this);
  }
  void take(const Load& load) override { list.push_back(load); }

  Vec3 on(std::uint32_t particle, Load::Kind kind) const {
    Vec3 sum;
    for (const Load& load : list)
      if (load.particle == particle && load.kind == kind) sum += load.force;
    return sum;
  }
  std::vector<Load> list;
};

}  // namespace iota::ingredient
