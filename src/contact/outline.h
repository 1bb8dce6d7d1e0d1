// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/box_tree.h"
#include "geometry/triangle_tree.h"
#include "math/mat3.h"
#include "shape/shape.h"

#include <iota/shapes.h>
#include <iota/vec3.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

/// Outlines: the surfaces with which bodies touch, at their places. Lengths in m, places in the world frame unless a function says otherwise.
namespace iota::contact {

/// A shape with what questions about it need. It does not change, so that solids share it.
struct Form {
  Shape shape;                                            ///< a mesh without its triangles
  std::unique_ptr<const geometry::TriangleTree> mesh;     ///< of a mesh
  std::unique_ptr<const geometry::TriangleTree> surface;  ///< of a shape that is neither a mesh nor convex
  geometry::Bounds box;                                   ///< in its frame
  bool is_endless = false;
};
std::shared_ptr<const Form> make_form(Shape);
/// Triangles that need not be closed: they have no inside.
std::shared_ptr<const Form> make_open_form(Mesh);
/// Whether each line between two points of a shape is in it.
bool is_convex(const Shape&);

/// The nearest point of its surface, and whether a place is inside; in its frame.
Vec3 closest(const Form&, const Vec3& place);
bool is_within(const Form&, const Vec3& place);
/// A farthest point of it in a direction, which is not zero; in its frame. Of a mesh: of its hull.
Vec3 support(const Form&, const Vec3& direction);

struct Solid {
  std::shared_ptr<const Form> form;
  std::uint32_t number = 0;  ///< of the owner
  Vec3 position;             ///< of the shape's origin
  Quaternion turn;           ///< of its frame
};

inline Vec3 to_world(const Solid& solid, const Vec3& place) { return solid.position + rotate(solid.turn, place); }
inline Vec3 to_local(const Solid& solid, const Vec3& place) {
  return rotate(conjugate(solid.turn), place - solid.position);
}

/// The unit vector out of a half-space, in the world.
Vec3 outwards(const Solid& half_space);

/// All points within the radius of a line; a ball if its ends are one.
struct Line {
  std::uint32_t p = 0, q = 0;  ///< of the owner
  double radius = 0;
  Vec3 a, b;  ///< its ends
};

/// The point of its middle line that is nearest to a place.
Vec3 nearest_of_middle(const Line&, const Vec3& place);

/// The union of its parts.
struct Outline {
  std::vector<Solid> solids;
  std::vector<Line> lines;
};

/// The point of a surface that is nearest to a place, and its distance, negative inside.
struct Near {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 point;
};
Near near(const Outline&, const Vec3& place);
/// The distance along a ray at which it meets the outline, 0 for a start inside. Lines are met to a millionth of their
/// radius.
std::optional<double> meet(const Outline&, const Vec3& from, const Vec3& unit, double farthest);
/// Whether it has a point in common with a convex bounded shape.
bool is_overlapped(const Outline&, const Solid& probe);
/// All parts are at most so far from a place that is fixed on them, m. Bounds of the distances of the parts, rounded up to
/// three digits, so that it is the same number wherever the body is and however it is turned.
double reach(const Outline&, const Vec3& place);
/// The box of all parts; infinite for an endless one.
geometry::Bounds bounds(const Outline&);
/// The box of a part, relative to an anchor.
geometry::Bounds bounds(const Solid&, const Vec3& anchor);
geometry::Bounds bounds(const Line&, const Vec3& anchor);

}  // namespace iota::contact
