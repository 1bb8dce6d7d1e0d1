// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"
#include "contact/touch.h"

#include <vector>

namespace iota::contact {

/// A touch of a body with a part of an obstacle.
struct TouchOfPart {
  Touch touch;
  const Outline* obstacle = nullptr;
  bool is_first = false;  ///< the obstacle is the first outline of the touch
  // Found by drop_seams: the part, none of a line, and its plane.
  const Solid* solid = nullptr;
  Vec3 place, normal;  ///< on its surface, and towards the body
};

/// A part of an obstacle whose edge or side is no place to meet it: what touches it does so with its face along a normal.
struct Seam {
  const Outline* obstacle = nullptr;
  Vec3 normal;  ///< towards the body
};

/// Drops the touches with edges and sides at which parts of obstacles meet: a part that is nowhere above the plane of another
/// touch cannot be met at a place that belongs to the other part, too. What rolled over tiles was thrown up, and what slid was
/// stopped. The others keep their order. size: of the body, m. seams: of each dropped touch, appended.
void drop_seams(std::vector<TouchOfPart>&, double size, std::vector<Seam>& seams);

}  // namespace iota::contact
