// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outlines.h"
#include "ingredient/model.h"
#include "step/joined_bodies.h"

#include <cstdint>
#include <utility>

namespace iota::step {

/// Body slots; the second is the obstacle, or the larger one.
using BodyPair = std::pair<std::uint32_t, std::uint32_t>;

/// Whether it has a place alone.
bool is_particle(const model::Body&, const contact::Outlines&, std::uint32_t body);
/// Whether it has an outline with a material now.
bool may_touch(const model::Model&, const contact::Outlines&, std::uint32_t body);
/// Whether one feels what touches it, without a force.
bool is_sensor(const model::Model&, const BodyPair&);
/// Whether two bodies that are near each other may touch: their materials and what joins them say it.
bool touch_each_other(model::Model&, contact::Outlines&, JoinedBodies&, const BodyPair&);

}  // namespace iota::step
