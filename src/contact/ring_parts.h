// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/convex_part.h"
#include "contact/outline.h"
#include "contact/touch.h"

#include <vector>

namespace iota::contact {

/// Appends the touches of a ring, the first or the second one, and a convex solid that is neither a ball nor a rod: at most four, where
/// the middle line of the ring is nearest to it, and six around one that lies on a face.
///   on a face        the ball of the wire, or of the whole ring where it bends away
///   on an edge, a rim, the side of a cylinder or a cone   a wire that crosses that of the ring
///   on a corner, an ellipsoid                             a ball
/// Where the middle line is within the solid, it is pushed out of the nearest face.
/// part: of the solid, placed about the anchor.
void add_touches_of_ring(const Solid& ring, const Solid& solid, const ConvexPart& part, bool is_ring_second,
                         const Vec3& anchor, double within, std::vector<Touch>& found);

}  // namespace iota::contact
