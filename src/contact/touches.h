// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"
#include "contact/touch.h"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace iota::contact {

/// Finds the touches of an outline with another one. The corners, ends and rims of the first are looked at, not those of
/// the second: the edge of a table against the face of a box is not found. The other is met as contact::near says.
class TouchFinder {
 public:
  /// Appends those with gaps of at most `within`, m, in a fixed order. spin: of the body, rad/s.
  void find(const Outline& body, const Vec3& spin, const Outline& other, double within, std::vector<Touch>& found);

 private:
  const std::vector<Vec3>& corners_of(const std::shared_ptr<const Form>&);

  struct Corners {
    std::weak_ptr<const Form> form;
    std::vector<Vec3> places;
  };
  std::map<const Form*, Corners> corners_;  ///< of meshes: the vertices of their hulls
};

}  // namespace iota::contact
