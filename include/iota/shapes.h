// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

/// Shapes: homogeneous solids, surfaces that constraints hold points on, sources of particles. One frame convention for
/// all: the origin is at the center, the long axis is x, sizes are full (except radii). Lengths in m. Drawings and
/// formulas are in the header of each, src/shape/<name>.h.
namespace iota {

struct Sphere {
  double radius = 0.5;
  friend bool operator==(const Sphere&, const Sphere&) = default;
};
struct Box {
  Vec3 size{1, 1, 1};   ///< edges along x, y, z
  double rounding = 0;  ///< radius of its edges, at most half the least edge
  friend bool operator==(const Box&, const Box&) = default;
};
/// Along x, from -length/2 to +length/2.
struct Cylinder {
  double radius = 0.5, length = 1;
  double rounding = 0;  ///< radius of its edges, at most its radius and half its length
  friend bool operator==(const Cylinder&, const Cylinder&) = default;
};
/// A cylinder along x with half spheres at its ends; `length` is that of the cylinder.
struct Capsule {
  double radius = 0.5, length = 1;
  friend bool operator==(const Capsule&, const Capsule&) = default;
};
/// A ring in the x-y plane: its center line has `radius`, its wire `tube`. Its halves may be pulled apart along x by
/// `stretch`, with straight wires between them: a link of a chain.
struct Torus {
  double radius = 0.5, tube = 0.1, stretch = 0;
  friend bool operator==(const Torus&, const Torus&) = default;
};
/// The volume within a closed surface of triangles; seen from outside each triangle is counter-clockwise.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of vertices
  friend bool operator==(const Mesh&, const Mesh&) = default;
};

/// A ball that is stretched along x, y, z.
struct Ellipsoid {
  Vec3 size{1, 1, 1};  ///< whole axes
  friend bool operator==(const Ellipsoid&, const Ellipsoid&) = default;
};
/// All points r with normal . r <= 0: the ground, a wall. It has no volume: static and scripted bodies can be one, and
/// constraints hold points on its plane.
struct HalfSpace {
  Vec3 normal{0, 1, 0};
  friend bool operator==(const HalfSpace&, const HalfSpace&) = default;
};
/// Along x: its base at -length/2, its tip at +length/2.
struct Cone {
  double radius = 0.5, length = 1;
  friend bool operator==(const Cone&, const Cone&) = default;
};

/// Their order is that of protocol/shapes.json, and never changes.
using Shape = std::variant<Sphere, Box, Cylinder, Capsule, Torus, Mesh, Ellipsoid, HalfSpace, Cone>;

using Matrix3 = std::array<Vec3, 3>;  ///< three rows

struct MassProperties {
  double volume = 0;     ///< m^3
  Vec3 center;           ///< of mass, in the shape's frame, m
  Matrix3 mean_squares;  ///< mean of r r' over the volume, r from the center, m^2; inertia = mass (trace I - this)
};

/// Closed forms; for meshes the divergence theorem (Eberly, Polyhedral Mass Properties, 2002), exact for any closed
/// surface, convex or not. Throws std::invalid_argument for sizes that are not positive, for shapes without a volume,
/// and for meshes that are open, inside out, flat, inconsistently wound or have invalid indices: the text names the
/// triangle or edge.
MassProperties mass_properties(const Shape& shape);

/// The convex hull: a closed mesh whose vertices are some of the points, in their order. Inner, coplanar and duplicate
/// points are allowed; hulls that are flatter than 1e-9 of their extent are refused. O(n log n). Throws
/// std::invalid_argument for fewer than four points, for points that are not finite, and if all are at one place, on
/// one line or in one plane. Quickhull: Barber, Dobkin, Huhdanpaa 1996.
Mesh convex_hull(std::span<const Vec3> points);

/// Land as an open mesh: heights above y = 0 (m) at the corners of a grid of `along` rows, which go along x, by `across` columns along z,
/// one row after the other. It is as large as these two lengths (m), about the origin. Throws std::invalid_argument for
/// fewer than two rows or columns, another number of heights, heights that are not finite and sizes that are not positive.
Mesh height_field(std::span<const double> heights, std::size_t along, std::size_t across, double size_x, double size_z);

}  // namespace iota
