// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/form_cache.h"
#include "contact/outline.h"
#include "contact/touch.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace iota::contact {

/// Some parts of an outline.
struct PartList {
  std::vector<const Solid*> solids;
  std::vector<const Line*> lines;

  void clear() { solids.clear(), lines.clear(); }
  bool is_empty() const { return solids.empty() && lines.empty(); }
};

/// Finds the touches of corners, ends, rims and lowest points with half-spaces and with all near faces of meshes that are not
/// convex, and those of corners of such meshes with the nearest place of other parts. Edges are met by MeshEdges.
class CornerFinder {
 public:
  /// How the touches are named: whether the corners are those of the second outline, and a number of the planes.
  struct Names {
    bool is_turned = false;
    std::uint32_t planes = 0;
  };
  /// Appends those with gaps of at most `within`, m, in a fixed order. spin: of the body with the corners in half
  /// a step, rad.
  void find(const PartList& corners, const Vec3& spin, const PartList& planes, double within, const Names&,
            std::vector<Touch>& found);

 private:
  const std::vector<Vec3>& corners_of(const std::shared_ptr<const Form>&);

  FormCache<std::vector<Vec3>> corners_;  ///< of meshes: the vertices of their hulls
};

}  // namespace iota::contact
