// SPDX-License-Identifier: Apache-2.0
#include "ingredient/joint_frames.h"

#include "base/text.h"
#include "math/mat3.h"
#include "model/solid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace iota::ingredient::joint {

Vec3 unit(const Vec3& v) {
  const Vec3 scaled = (1 / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)})) * v;
  return (1 / norm(scaled)) * scaled;
}

Side::Side(const Model& model, std::uint32_t slot) : body(slot) {
  const model::Body& b = model.bodies[slot];
  dimensions = std::max(b.rank - 1, 0);
  for (int i = 0; i < dimensions; ++i) {
    Vec3 axis = model.position(b.basis[i + 1]) - model.position(b.basis[0]);
    extent = std::max(extent, norm(axis));
    for (int j = 0; j < i; ++j) axis -= dot(axis, axes[j]) * axes[j];
    axes[i] = unit(axis);
  }
}

bool Side::holds(Vec3 direction) const {
  for (int i = 0; i < dimensions; ++i) direction -= dot(direction, axes[i]) * axes[i];
  return dimensions == 3 || norm(direction) < straight;
}

std::string Side::what() const {
  constexpr const char* shapes[] = {"a point", "on one line", "flat", "solid"};
  return "body " + std::to_string(body) + " is " + shapes[dimensions];
}

void cannot(const char* kind, const std::string& why) { throw std::invalid_argument(std::string(kind) + ": " + why); }

namespace {

/// The gaps that the solver leaves in the rows of a thin body move places far outside of it by as many times its thickness: a sheet
/// held 3000 thicknesses beside it made 400 times its energy in 3 s. So an attachment bears such a place, and the end of a direction
/// across a needle. Where the body cannot give one, this is told.
void bear_far_place(Model& model, std::uint32_t body, std::uint32_t marker, const Vec3& at, bool is_origin) {
  const double far = is_origin ? 50 : 200;  // thicknesses; 3e-6 of the energy is made in 3 s
  constexpr double inexact = 300;           // 3e-3
  const auto most = [&] {
    double largest = 0;
    for (const double weight : model.affine.at(marker).weights) largest = std::max(largest, std::abs(weight));
    return largest;
  };
  if (most() <= far) return;
  if (const std::uint32_t solid = model::solid_that_gives(model, body, at); solid != model::none)
    model::attach(model, solid, at), model::carry_points(model, body);
  if (const double left = most(); left > inexact)
    model.notes.push_back(
        text("body ", body, " is held ", std::round(left),
             " times its thickness outside of it, where its motion is inexact; make it thicker, or weld a body "
             "to it that the joint holds"));
}

}  // namespace

void add_place(Model& model, Constraint& c, int place, std::uint32_t body, const Vec3& at) {
  const auto bit = static_cast<std::uint8_t>(1u << place);
  if (body == none) {
    c.fixed[place - b_origin] = at;
    c.in_world |= bit;
  } else {
    const std::uint32_t marker = c.particles[place] = model.make_marker(body, at);
    c.owned |= bit;
    bear_far_place(model, body, marker, at, place == a_origin || place == b_origin);
    // The ends of directions belong to the part of their origin, not to the nearest one.
    const std::uint32_t origin = c.particles[place < b_origin ? a_origin : b_origin];
    model.particles[marker].part = origin == marker ? model.part_at(body, at) : model.particles[origin].part;
  }
}

void require_frame(const char* kind, const Side& side) {
  if (side.dimensions < 3)
    cannot(kind, side.what() + " and holds no frame for a curve or surface; give it a massive particle off its plane");
}

void make_frame(Model& model, Constraint& c, const Side& side, int origin, const Vec3& at, const Quaternion& q) {
  const int which = origin == b_origin;
  c.scale[which] = side.extent > 0 ? side.extent : 1;
  const std::array<Vec3, 4> directions{Vec3{}, rotate(q, {0, 0, 1}), rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0})};
  for (int i = 0; i < 4; ++i) add_place(model, c, origin + i, side.body, at + c.scale[which] * directions[i]);
}

}  // namespace iota::ingredient::joint
