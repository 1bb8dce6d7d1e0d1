// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "model/structure.h"

#include <iota/shapes.h>

namespace iota::model {

/// The pose of a solid's own frame.
struct SolidPose {
  Vec3 position;           ///< of its origin, world, m
  Quaternion orientation;  ///< turns vectors of the shape's frame into the world frame
};
SolidPose solid_pose(const Structure&, std::uint32_t solid);

/// As the last one of its body; returns its slot.
std::uint32_t append_solid(Structure&, const Solid&);

/// Gives an empty body the four point masses of a solid, at rest. `solid` has kind, sizes and mesh; the rest is filled
/// in. mean_squares and center as in MassProperties.
std::uint32_t add_solid(Structure&, std::uint32_t body, Solid solid, double mass, const Vec3& center,
                        const Mat3& mean_squares, const SolidPose& pose);

/// Whether one of a body's shapes has no volume (a half-space, an open mesh). Such a body is static or scripted.
bool lacks_volume(const Structure&, std::uint32_t body);
bool lacks_volume(const Structure&, const shape::Data&);

/// Whether the four points of a solid may still be moved: they have no hinge, nail or bond, and equal masses.
bool may_move_points(const Structure&, std::uint32_t solid);

/// The solid of a body nearest to a place whose points may move, so that it can give mass to an attachment; `none` if there is none.
std::uint32_t solid_that_gives(const Structure&, std::uint32_t body, const Vec3& position);

/// Sets the points of a body that are not unknowns to what the basis says of them: places to their last bits, and velocities.
enum class Carried : std::uint8_t { all, velocities };
void carry_points(Structure&, std::uint32_t body, Carried = Carried::all);

/// A further particle of a body at a place (world). It takes a small share of mass from a solid, whose four points are
/// recomputed so that the body's mass, center of mass, inertia and motion do not change, to round-off.
std::uint32_t attach(Structure&, std::uint32_t solid, const Vec3& position);

/// Gives a body made of solids alone this mass, center of mass (world) and mean squares about it (world axes), whatever its
/// shapes are, which stay where they are. Its motion stays that of the same rigid body.
void set_mass_properties(Structure&, std::uint32_t body, double mass, const Vec3& center, const Mat3& mean_squares);

/// Inertia about the center of mass, world axes, kg m^2 (thesis, Eq. 2.28; inertia pairs included).
Mat3 body_inertia(const Structure&, std::uint32_t body);
Vec3 body_velocity(const Structure&, std::uint32_t body);          ///< of the center of mass, m/s
Vec3 body_angular_momentum(const Structure&, std::uint32_t body);  ///< about the center of mass, kg m^2/s
/// rad/s. Has no component about an axis without inertia: any axis of one point, or the line of collinear points.
Vec3 body_angular_velocity(const Structure&, std::uint32_t body);

}  // namespace iota::model
