// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"

#include <vector>

namespace iota::contact {

/// On which side of an open mesh each place of a ring is. The mesh has no inside, and a ring that hangs on a strip has its middle
/// below: the smaller part of a ring that crosses the mesh is the one that came through it.
class RingSides {
 public:
  RingSides(const Solid& torus, const Solid& mesh);
  /// Whether the place of the middle line that is nearest to this one came through the mesh.
  bool is_through(const Vec3& place) const;

 private:
  std::vector<Vec3> points_;  ///< of the middle line
  std::vector<char> sides_;   ///< of each; empty where it does not cross
  char other_side_ = 0;
};

}  // namespace iota::contact
