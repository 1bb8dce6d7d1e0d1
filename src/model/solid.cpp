// SPDX-License-Identifier: Apache-2.0
#include "model/solid.h"

#include "shape/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::model {

namespace {

/// Corners of a cube with an even number of minus signs. Their sum is zero, the sum of t t' four times the identity.
constexpr std::array<Vec3, 4> corners{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};

/// Places the four points so that they have these principal mean squares about their center; axes in the world frame.
void place_points(Structure& model, Solid& solid, const Vec3& center, const SymmetricEigen& e, const SolidPose& pose) {
  const auto root = [](double value) { return std::sqrt(std::max(value, 0.0)); };
  solid.half = {root(e.values[0]), root(e.values[1]), root(e.values[2])};
  const Quaternion inverse = conjugate(pose.orientation);
  solid.principal = multiply(inverse, from_axes(e.axes[0], e.axes[1], e.axes[2]));
  solid.center = rotate(inverse, center - pose.position);
  for (int k = 0; k < 4; ++k) {
    const Vec3& t = corners[k];
    model.rings[model.particles[solid.points[k]].ring].position =
        center + (t.x * solid.half.x) * e.axes[0] + (t.y * solid.half.y) * e.axes[1] + (t.z * solid.half.z) * e.axes[2];
  }
}

}  // namespace

SolidPose solid_pose(const Structure& model, std::uint32_t slot) {
  const Solid& solid = model.solids[slot];
  if (const Obstacle* const obstacle = model.obstacles.find(solid.body))
    return {obstacle->position, obstacle->orientation};
  Vec3 center, axes[3];
  for (int k = 0; k < 4; ++k) {
    const Vec3 x = model.position(solid.points[k]);
    center += 0.25 * x;
    axes[0] += (corners[k].x / (4 * solid.half.x)) * x;
    axes[1] += (corners[k].y / (4 * solid.half.y)) * x;
    axes[2] += (corners[k].z / (4 * solid.half.z)) * x;
  }
  const Quaternion q = multiply(from_axes(axes[0], axes[1], axes[2]), conjugate(solid.principal));
  return {center - rotate(q, solid.center), q};
}

std::uint32_t append_solid(Structure& model, const Solid& solid) {
  const std::uint32_t slot = model.solids.create(solid).slot;
  std::uint32_t* last = &model.bodies[solid.body].first_solid;
  while (*last != none) last = &model.solids[*last].next;
  return *last = slot;
}

std::uint32_t add_solid(Structure& model, std::uint32_t body, Solid solid, double mass, const Vec3& center,
                        const Mat3& mean_squares, const SolidPose& pose) {
  solid.body = body;
  const Vec3 world_center = pose.position + rotate(pose.orientation, center);
  for (std::uint32_t& point : solid.points) point = model.make_particle(body, world_center, mass / 4, {});
  SymmetricEigen principal = symmetric_eigen(mean_squares);
  for (Vec3& axis : principal.axes) axis = rotate(pose.orientation, axis);
  place_points(model, solid, world_center, principal, pose);
  const std::uint32_t slot = append_solid(model, solid);
  model.rebuild_basis(body);
  model.mark_body(body);
  return slot;
}

bool lacks_volume(const Structure& model, const shape::Data& data) {
  return data.key != 0 ? model.meshes.is_open(data.key) : !shape::is_solid(shape::from_data(data));
}

bool lacks_volume(const Structure& model, std::uint32_t body) {
  bool lacks = false;
  model.for_each_solid_of(
      body, [&](std::uint32_t solid) { lacks = lacks || lacks_volume(model, model.solids[solid].shape); });
  return lacks;
}

bool may_move_points(const Structure& model, std::uint32_t slot) {
  const auto& points = model.solids[slot].points;
  const double mass = model.particles[points[0]].mass;
  return std::none_of(points.begin(), points.end(), [&](std::uint32_t p) {
    return model.is_needed(model.particles[p]) || std::abs(model.particles[p].mass - mass) > 1e-9 * mass;
  });
}

std::uint32_t solid_that_gives(const Structure& model, std::uint32_t body, const Vec3& position) {
  std::uint32_t solid = none;
  double nearest = 0;
  model.for_each_solid_of(body, [&](std::uint32_t s) {
    const double distance = norm(solid_pose(model, s).position - position);
    if (may_move_points(model, s) && (solid == none || distance < nearest)) solid = s, nearest = distance;
  });
  return solid;
}

void carry_points(Structure& model, std::uint32_t body, Carried what) {
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (model.is_unknown(model.particles[p])) return;
    Ring& ring = model.rings[model.particles[p].ring];
    const auto [position, velocity] = model.carried(p);
    if (what == Carried::all) ring.position = position;
    ring.velocity = velocity;
  });
}

namespace {

/// Gives a body a velocity and a spin although the points that other bodies share keep their velocities, which are not quite rigid:
/// its own points take what these lack. As far as that is little: through shared points far outside it may grow.
void match_motion(Structure& model, std::uint32_t body, const Vec3& velocity, const Vec3& spin) {
  constexpr int most_passes = 60;
  const Vec3 center = model.center_of_mass(body);
  const auto add = [&](const Vec3& push, const Vec3& turn) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      Ring& ring = model.rings[model.particles[p].ring];
      if (ring.count == 1) ring.velocity += push + cross(turn, ring.position - center);
    });
    carry_points(model, body, Carried::velocities);
  };
  Vec3 push, turn;
  double lacks = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < most_passes; ++pass) {
    const Vec3 next_push = velocity - body_velocity(model, body), next_turn = spin - body_angular_velocity(model, body);
    const double next = norm(next_push) + norm(next_turn) * model.extent(body);
    if (!(next < lacks)) return add(-push, -turn);
    push = next_push, turn = next_turn, lacks = next;
    add(push, turn);
  }
}

}  // namespace

std::uint32_t attach(Structure& model, std::uint32_t slot, const Vec3& position) {
  const SolidPose pose = solid_pose(model, slot);
  Solid& solid = model.solids[slot];
  const Vec3 spin = body_angular_velocity(model, solid.body);
  const Vec3 velocity = body_velocity(model, solid.body), body_center = model.center_of_mass(solid.body);

  double mass = 0;
  Vec3 center;
  Mat3 squares;
  for (const std::uint32_t p : solid.points) mass += model.particles[p].mass, center += 0.25 * model.position(p);
  for (const std::uint32_t p : solid.points) {
    const Vec3 r = model.position(p) - center;
    squares += 0.25 * Mat3::outer(r, r);
  }
  // The share is small enough for positive second moments at any distance of the place: at most a ten thousandth of the
  // mass, and a fiftieth of the second moment along the arm.
  const Vec3 arm = position - center;
  const double reach = dot(arm, solve_semidefinite(squares, arm, 1e-14));
  const double share = std::min(1e-4, 0.02 / (reach + 1e-300)), rest = 1 - share;
  const Vec3 shift = (-share / rest) * arm;  // of the four points' center
  Mat3 remaining = squares + -share * Mat3::outer(arm, arm);
  remaining = (1 / rest) * remaining + -1.0 * Mat3::outer(shift, shift);

  for (const std::uint32_t p : solid.points) model.particles[p].mass = rest * mass / 4;
  place_points(model, solid, center + shift, symmetric_eigen(remaining), pose);
  const auto motion = [&](const Vec3& x) { return velocity + cross(spin, x - body_center); };
  const std::uint32_t body = solid.body;
  const std::uint32_t particle = model.make_particle(body, position, share * mass, motion(position));
  model.rebuild_basis(body);
  // Velocities of the schemes are rigid only on average, or to the order of a step: a new basis would give the others different ones.
  bool shares = false;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    Ring& ring = model.rings[model.particles[p].ring];
    if (ring.count == 1)
      ring.velocity = motion(ring.position);
    else
      shares = true;
  });
  carry_points(model, body, Carried::velocities);
  if (shares) match_motion(model, body, velocity, spin);
  model.mark_body(body);
  return particle;
}

// The four points of each solid have all of the center and spread, and an equal share of the mass.
void set_mass_properties(Structure& model, std::uint32_t body, double mass, const Vec3& center,
                         const Mat3& mean_squares) {
  const Vec3 spin = body_angular_velocity(model, body), velocity = body_velocity(model, body);
  const Vec3 former = model.center_of_mass(body);
  const SymmetricEigen principal = symmetric_eigen(mean_squares);
  int count = 0;
  model.for_each_solid_of(body, [&](std::uint32_t) { ++count; });
  model.for_each_solid_of(body, [&](std::uint32_t slot) {
    Solid& solid = model.solids[slot];
    place_points(model, solid, center, principal, solid_pose(model, slot));
    for (const std::uint32_t p : solid.points) {
      Ring& ring = model.rings[model.particles[p].ring];
      model.particles[p].mass = mass / (4 * count);
      ring.velocity = velocity + cross(spin, ring.position - former);
    }
  });
  model.rebuild_basis(body);
  model.mark_body(body);
}

Mat3 body_inertia(const Structure& model, std::uint32_t body) {
  const Vec3 center = model.center_of_mass(body);
  Mat3 inertia;
  model.for_each_particle_of(
      body, [&](std::uint32_t p) { inertia += point_inertia(model.particles[p].mass, model.position(p) - center); });
  model.for_each_inertia_of(body, [&](std::uint32_t i) {
    const InertiaPair& pair = model.inertia_pairs[i];
    inertia += point_inertia(pair.inertia, model.position(pair.p) - model.position(pair.q));
  });
  if (const double axial = model.axial_inertia(body); axial > 0)
    inertia += axial * Mat3::outer(model.rod_axis(body), model.rod_axis(body));
  return inertia;
}

Vec3 body_velocity(const Structure& model, std::uint32_t body) {
  double mass = 0;
  Vec3 sum;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    mass += model.particles[p].mass;
    sum += model.particles[p].mass * model.velocity(p);
  });
  return mass > 0 ? (1 / mass) * sum : sum;
}

Vec3 body_angular_momentum(const Structure& model, std::uint32_t body) {
  const Vec3 center = model.center_of_mass(body);
  Vec3 sum;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    sum += model.particles[p].mass * cross(model.position(p) - center, model.velocity(p));
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) {
    const InertiaPair& pair = model.inertia_pairs[i];
    sum += pair.inertia *
           cross(model.position(pair.p) - model.position(pair.q), model.velocity(pair.p) - model.velocity(pair.q));
  });
  return sum + model.inner_momentum(body);
}

Vec3 body_angular_velocity(const Structure& model, std::uint32_t body) {
  if (model.bodies[body].rank <= 1) return {};  // its inertia is round-off
  return solve_semidefinite(body_inertia(model, body), body_angular_momentum(model, body));
}

}  // namespace iota::model
