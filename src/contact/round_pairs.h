// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/manifold.h"

namespace iota::contact {

/// The touches of balls, capsules and rods with each other.
void add_touches_of_segments(TouchWriter&);
/// The touches of two parts of which corners, or a corner and an edge, or parallel edges are nearest to each other: those
/// for which no face and no crossing edges are a plane between them. `apart`: of the cores, along the best axis. False:
/// it is the distance.
bool add_touches_of_corners(TouchWriter&, double apart);

}  // namespace iota::contact
