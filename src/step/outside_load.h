// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/model.h"

namespace iota::step {

/// What acted from outside on one part of a body in the last step: gravity, bonds, hinges, nails, constraints, hands,
/// applied forces, damping. The net force of the part is this and what the other parts do to it.
struct OutsideLoad {
  Vec3 force;   ///< N
  Vec3 torque;  ///< about the part's center of mass, N m
};
OutsideLoad calc_outside_load(const model::Model&, std::uint32_t body, BodyId part);

}  // namespace iota::step
