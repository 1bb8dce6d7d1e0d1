// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"
#include "contact/touch.h"
#include "geometry/box_tree.h"
#include "math/mat3.h"

#include <iota/shapes.h>

#include <cstdint>
#include <vector>

namespace iota::contact {

/// The edges of a mesh on which another body may lie though no corner of either touches the other: where faces bend, or end. Edges
/// within a flat face are none, also if its triangles have corners of their own there. In the mesh's frame.
class MeshEdges {
 public:
  struct Edge {
    Vec3 a, b;
    Vec3 into[2];  ///< unit vectors at right angles to it, along its faces; the second is zero where there is one face
    Vec3 normal;   ///< of one face, where there is one
    bool has_two() const { return dot(into[1], into[1]) > 0; }
    /// Away from both faces where they bend, or the normal of one.
    Vec3 outwards() const { return has_two() ? unit_or(-(into[0] + into[1]), normal) : normal; }
    /// Outward normal of a face, where there are two.
    Vec3 normal_of_face(std::size_t face) const {
      const Vec3 away = outwards();
      return unit_or(away - dot(away, into[face]) * into[face], normal);
    }
    /// Whether a body may be pushed away in this direction, and not by one of the faces. An edge where a face ends pushes about
    /// along the normal alone: its neighbor may only not fit, and would stop what slides.
    bool may_push(const Vec3& away) const;
  };

  /// is_closed: edges of hollows are none.
  MeshEdges(const Mesh&, bool is_closed);

  /// Calls visit(number, edge) with those whose boxes overlap this one.
  template <class Visit>
  void overlapping(const geometry::Bounds& box, Visit visit) const {
    tree_.overlapping(box, [&](std::uint32_t edge) { visit(edge, edges_[edge]); });
  }
  std::size_t size() const { return edges_.size(); }

 private:
  std::vector<Edge> edges_;
  geometry::BoxTree tree_;
};

/// A mesh at its place, with its edges.
struct EdgedSolid {
  const Solid& solid;
  const MeshEdges& edges;
};
/// Appends the touches of edges of two meshes that cross each other. first_feature: of their names.
void add_touches_of_edges(const EdgedSolid& first, const EdgedSolid& second, std::uint32_t first_feature,
                          const Vec3& anchor, double within, std::vector<Touch>& found);

}  // namespace iota::contact
