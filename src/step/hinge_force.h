// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/model.h"

namespace iota::step {

/// Force in the last step on the body of a particle by all that shares or nails the particle's place, N: what the hinge
/// carries. Inverse dynamics from accelerations and multipliers. Those of one hinge add up to zero (with its nail); a
/// force that was applied to the shared particle itself counts as held by all its bodies alike.
Vec3 calc_hinge_force(const model::Model&, std::uint32_t particle);

}  // namespace iota::step
