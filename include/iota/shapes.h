// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

/// Homogeneous solids, each in a frame of its own, and their mass properties. Lengths in m.
namespace iota {

struct Sphere {
  double radius = 0.5;
};
struct Box {
  Vec3 size{1, 1, 1};  ///< edges along x, y, z
};
/// Along x, from -length/2 to +length/2.
struct Cylinder {
  double radius = 0.5, length = 1;
};
/// A cylinder along x with half spheres at its ends; `length` is that of the cylinder.
struct Capsule {
  double radius = 0.5, length = 1;
};
/// A ring in the x-y plane: its center line has `radius`, its wire `tube`.
struct Torus {
  double radius = 0.5, tube = 0.1;
};
/// What a closed surface of triangles encloses; seen from outside each triangle runs counter-clockwise.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< numbers of vertices
};

using Shape = std::variant<Sphere, Box, Cylinder, Capsule, Torus, Mesh>;

using Matrix3 = std::array<Vec3, 3>;  ///< three rows

struct MassProperties {
  double volume = 0;     ///< m^3
  Vec3 center;           ///< of mass, in the shape's frame, m
  Matrix3 mean_squares;  ///< mean of r r' over the volume, r from the center, m^2; inertia = mass (trace I - this)
};

/// Closed forms; for meshes the divergence theorem (Eberly, Polyhedral Mass Properties, 2002), exact for any closed
/// surface, convex or not. Throws std::invalid_argument for sizes that are not positive, and for meshes that are open,
/// inside out, flat, inconsistently wound or name vertices that are not there: the text says which triangle or edge.
MassProperties mass_properties(const Shape& shape);

/// What a rubber skin round the points encloses: a closed mesh whose vertices are some of them, in their order. Points
/// within, on faces and given twice do no harm; what is flatter than 1e-9 of its extent is no solid. O(n log n).
/// Throws std::invalid_argument for fewer than four points, for points that are not finite, and where all are at one
/// place, on one line or in one plane. Quickhull: Barber, Dobkin, Huhdanpaa 1996.
Mesh convex_hull(std::span<const Vec3> points);

}  // namespace iota
