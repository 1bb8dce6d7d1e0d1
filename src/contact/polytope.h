// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace iota {
struct Mesh;
}

namespace iota::contact {

/// A convex polytope by its corners, edges and faces, in its own frame. A point has no edges, a segment no faces.
struct Polytope {
  static constexpr std::uint32_t none = 0xffffffff;
  struct Side {
    std::uint32_t corner, edge;  ///< the side goes from this corner to that of the next side
  };
  struct Face {
    Vec3 normal;               ///< outward unit vector
    std::uint32_t begin, end;  ///< of its sides, counter-clockwise seen from outside
  };
  struct Edge {
    std::uint32_t from, to;
    std::uint32_t left = none, right = none;  ///< faces: the left one has the edge from `from` to `to`
  };
  std::vector<Vec3> corners;
  std::vector<Edge> edges;
  std::vector<Face> faces;
  std::vector<Side> sides;  ///< of all faces
};

/// With one corner, at the origin.
const Polytope& point_polytope();
/// With two corners, at -1 and 1 on the x axis.
const Polytope& segment_polytope();
/// The cube of corners (+-1, +-1, +-1). Bits 0 to 2 of a corner's number: x, y, z are positive; face 2 k is at -1 along
/// axis k, face 2 k + 1 at +1; edge 4 k + 2 b + c is along axis k, at the sides b and c of the next two axes.
const Polytope& cube_polytope();
/// In a cylinder and a cone of radius 1 around the x axis, from -1 to 1. Corners 0 to 11 are on the rim at -1, face 0 is
/// there; of the prism corners 12 to 23 and face 1 are at 1, of the pyramid corner 12.
constexpr std::uint32_t corners_of_rim = 12;
const Polytope& prism_polytope();
const Polytope& pyramid_polytope();
/// The faces of a hull of triangles: coplanar triangles become one. The corners keep their numbers.
Polytope make_polytope(const Mesh& hull);
/// The same of a closed mesh, if it is convex.
std::optional<Polytope> try_polytope(const Mesh&);

}  // namespace iota::contact
