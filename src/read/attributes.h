// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

namespace iota::read {

/// Age, lifetime and look of a particle; the look of an emitted one is interpolated on its emitter's curve by age.
ParticleAttributes attributes(const model::Model&, const model::Attributes&);

/// Null for a particle without attributes.
const model::Attributes* find_attributes(const model::Model&, std::uint32_t particle);

/// Throws std::invalid_argument for a particle without an orientation of its own.
const model::Attributes& oriented_attributes(const model::Model&, std::uint32_t particle);

}  // namespace iota::read
