// SPDX-License-Identifier: Apache-2.0
#include "read/orientations.h"

#include "math/mat3.h"
#include "model/solid.h"

#include <algorithm>
#include <cmath>

namespace iota::read {

using model::none;

namespace {

constexpr double no_length = 1e-12;  // m: without a direction

/// Whether a vector has the direction of a unit vector to round-off; also if it is zero.
bool is_along(const Vec3& v, const Vec3& unit) {
  constexpr double round_off = 1e-14;
  const Vec3 across = cross(unit, v);
  return dot(across, across) <= round_off * round_off * dot(v, v) && dot(unit, v) >= 0;
}

/// Whether the frame of a body follows from the places of its points.
bool has_no_past(const model::Body& b) { return b.first_solid != none || b.rank > 2; }

void refresh_frame(const model::Model& model, model::Body& b) {
  if (b.first_solid != none) {
    b.orientation = solid_pose(model, b.first_solid).orientation;
    return;
  }
  const Vec3 x0 = model.position(b.basis[0]);
  const Vec3 x = unit_or(model.position(b.basis[1]) - x0, rotate(b.orientation, {1, 0, 0}), no_length);
  const Vec3 in_plane = model.position(b.basis[2]) - x0;
  const Vec3 y = unit_or(in_plane - dot(in_plane, x) * x, any_perpendicular(x), no_length);
  b.orientation = from_axes(x, y, cross(x, y));
}

}  // namespace

void Orientations::refresh(model::Model& model, std::span<const std::uint32_t> bodies) {
  if (!std::all_of(bodies.begin(), bodies.end(), [&](std::uint32_t body) { return has_no_past(model.bodies[body]); }))
    return refresh(model);
  for (const std::uint32_t body : bodies) refresh_frame(model, model.bodies[body]);
}

void Orientations::refresh(model::Model& model) {
  const std::uint64_t now = model.step << 32 | model.structure_version;
  if (now == made_for_) return;
  const bool has_stepped = made_for_ >> 32 != now >> 32;
  made_for_ = now;

  model.bodies.for_each([&](std::uint32_t slot, model::Body& b) {
    if (has_no_past(b)) return refresh_frame(model, b);
    if (b.rank < 2) {  // a ball may have an orientation
      const std::uint32_t a = b.rank > 0 ? model.particles[b.basis[0]].attributes : none;
      if (a != none && model.attributes[a].oriented) b.orientation = model.attributes[a].orientation;
      return;
    }
    const Vec3 x0 = model.position(b.basis[0]), along = model.position(b.basis[1]) - x0;
    const Vec3 old_x = rotate(b.orientation, {1, 0, 0});
    // Most rods have not turned since an edit between two steps.
    if (is_along(along, old_x) && !model.spins.has(slot)) return;
    const Vec3 x = unit_or(along, old_x, no_length);
    // Turn the frame by the smallest rotation, and about its axis by the spin.
    b.orientation = normalized(multiply(shortest_turn(old_x, x), b.orientation));
    if (ingredient::RodSpin* const spin = model.spins.find(slot)) {
      const double sign = dot(x, model.rod_axis(slot)) < 0 ? -1 : 1;
      b.orientation = normalized(multiply(axis_angle(x, sign * (spin->angle - spin->drawn)), b.orientation));
      spin->drawn = spin->angle;
    }
  });

  // Smallest rotations accumulate a twist between neighbors on closed paths. Frames of rods are turned back towards
  // that of the rod above, a little in each step and not near a fold, so that chain links neither drift nor flip.
  if (!has_stepped) return;
  constexpr double share = 0.15, largest_turn = 0.15;
  model.bodies.for_each([&](std::uint32_t slot, model::Body& b) {
    if (b.rank != 2 || model.spins.has(slot)) return;
    std::uint32_t upper = slot;
    model.for_each_in_ring(model.particles[b.basis[0]].ring, [&](std::uint32_t p) {
      const std::uint32_t other = model.particles[p].body;
      if (other < upper && model.bodies[other].rank == 2) upper = other;
    });
    if (upper == slot) return;
    const Quaternion& u = model.bodies[upper].orientation;
    const Vec3 ux = rotate(u, {1, 0, 0}), x = rotate(b.orientation, {1, 0, 0});
    if (dot(ux, x) < -0.7) return;
    const Vec3 wanted = rotate(shortest_turn(ux, x), rotate(u, {0, 1, 0})), y = rotate(b.orientation, {0, 1, 0});
    const double twist = std::atan2(dot(cross(y, wanted), x), dot(y, wanted));
    b.orientation =
        normalized(multiply(axis_angle(x, std::clamp(share * twist, -largest_turn, largest_turn)), b.orientation));
  });
}

}  // namespace iota::read
