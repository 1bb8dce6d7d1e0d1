// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/data.h"

#include <iota/shapes.h>

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Functions of any shape: folds over the list. Points and directions are in the shape's frame, lengths in m.
namespace iota::shape {

class Surface;

Data to_data(const Shape&);
/// A mesh comes back empty. Throws std::invalid_argument for a number that is not in the list.
Shape from_data(const Data&);

std::string_view name(const Shape&);
/// The names of all sizes, one for each number of Data: "size_x", "rounding".
std::vector<std::string> size_names(const Shape&);
/// Throws std::invalid_argument for sizes that are out of range or inconsistent. (A mesh's triangles are checked
/// where a body gets it.)
void check(const Shape&);
/// Whether it has a volume, and so mass properties: neither a half-space nor a mesh that is not closed.
bool is_solid(const Shape&);

/// Its surface, for constraints. Throws std::invalid_argument for sizes that are out of range, and for shapes that cannot
/// constrain points.
std::shared_ptr<const Surface> make_surface(const Shape&);

/// Whether a point is inside, or on the surface.
bool is_within(const Shape&, const Vec3& p);
/// The nearest point of the surface.
Vec3 closest(const Shape&, const Vec3& p);
/// From the surface, negative inside.
double distance(const Shape&, const Vec3& p);
/// A farthest point in a direction that is not zero; infinite if the shape is.
Vec3 support(const Shape&, const Vec3& direction);
/// Distance along a ray from a point, along a unit vector, to the surface; 0 for a start inside. Nothing if there is no
/// hit within `farthest`.
std::optional<double> ray(const Shape&, const Vec3& from, const Vec3& unit,
                          double farthest = std::numeric_limits<double>::infinity());

/// The least box along the axes.
struct Bounds {
  Vec3 low, high;
};
Bounds bounds(const Shape&);

/// A closed mesh with its vertices on the surface, finer for a higher number: for a convex shape the hull of that many
/// points. Throws std::invalid_argument for an infinite shape.
Mesh triangulate(const Shape&, std::uint32_t fineness);

/// A uniformly random place within. number(low, high) draws a number. Throws std::invalid_argument if there is none.
bool is_source(const Shape&);
Vec3 inside(const Shape&, const std::function<double(double, double)>& number);

}  // namespace iota::shape
