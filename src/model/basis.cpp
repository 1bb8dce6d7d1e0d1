// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"
#include "model/restructure.h"

#include <algorithm>
#include <cmath>

namespace iota::model {

namespace {

/// Distance of r (relative to the first basis point) from the span of `axes` orthonormal directions.
double distance_from_span(Vec3 r, const std::array<Vec3, 3>& axes, int count) {
  for (int i = 0; i < count; ++i) r -= dot(r, axes[i]) * axes[i];
  return norm(r);
}

}  // namespace

// The first particle, then thrice the particle farthest from the span so far: well-conditioned, and for a rod simply its
// two ends. Everything else is an affine combination of these. A body made of solids prefers points that are unknowns
// anyway, as long as they reach a fifth as far. Ties go to the earlier one, whatever round-off says.
void Model::rebuild_basis(std::uint32_t body_slot) {
  constexpr double flat = 1e-7;  // of the extent: thinner counts as a point, line or plane
  constexpr double tie = 1 + 1e-6, far_enough = 0.2;
  Body& body = bodies[body_slot];
  const std::array<std::uint32_t, 4> old_basis = body.basis;
  body.rank = 0, body.row_count = 0, body.basis_needs = 0;
  body.basis.fill(none);
  if (body.count == 0) return;

  std::uint32_t first = body.first;
  const auto is_preferred = [&](std::uint32_t p) { return body.first_solid != none && is_needed(particles[p]); };
  if (body.first_solid != none)
    for_each_particle_of(body_slot, [&](std::uint32_t p) {
      if (is_needed(particles[p]) && body.basis_needs++ == 0) first = p;
    });
  body.basis[body.rank++] = first;
  const Vec3 origin = position(first);
  std::array<Vec3, 3> axes;
  double extent = 0;
  for (int dimension = 0; dimension < 3; ++dimension) {
    std::uint32_t farthest = none, preferred = none;
    double distance = 0, preferred_distance = 0;
    for_each_particle_of(body_slot, [&](std::uint32_t p) {
      const double d = distance_from_span(position(p) - origin, axes, dimension);
      if (d > tie * distance) distance = d, farthest = p;
      if (d > tie * preferred_distance && is_preferred(p)) preferred_distance = d, preferred = p;
    });
    if (dimension == 0) extent = distance;
    if (farthest == none || !(distance > flat * extent)) break;
    if (preferred != none && preferred_distance > far_enough * distance) farthest = preferred;
    Vec3 axis = position(farthest) - origin;
    for (int i = 0; i < dimension; ++i) axis -= dot(axis, axes[i]) * axes[i];
    axes[dimension] = (1 / norm(axis)) * axis;
    body.basis[body.rank++] = farthest;
  }

  body.row_count = static_cast<std::uint8_t>(body.rank * (body.rank - 1) / 2);
  for (int row = 0; row < body.row_count; ++row) {
    const auto [i, j] = basis_pairs[row];
    body.lengths[row] = norm(position(body.basis[j]) - position(body.basis[i]));
  }
  if (old_basis != body.basis) body.multipliers.fill(0);  // a warm start of other rows would mislead

  // Weights: coordinates in the basis vectors, by the Gram matrix of those vectors.
  std::array<Vec3, 3> vectors;
  for (int i = 1; i < body.rank; ++i) vectors[i - 1] = position(body.basis[i]) - origin;
  Mat3 gram;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) gram.m[i][j] = dot(vectors[i], vectors[j]);
  const int rank = body.rank;
  for_each_particle_of(body_slot, [&](std::uint32_t p) {
    Particle& particle = particles[p];
    particle.basis_index = -1;
    particle.multiplier.fill(0);
    for (int i = 0; i < rank; ++i)
      if (bodies[body_slot].basis[i] == p) particle.basis_index = i;
    particle.weights.fill(0);
    if (particle.basis_index >= 0) {
      particle.weights[particle.basis_index] = 1;
      return;
    }
    const Vec3 r = position(p) - origin;
    const Vec3 c = solve_semidefinite(gram, {dot(vectors[0], r), dot(vectors[1], r), dot(vectors[2], r)}, 1e-15);
    particle.weights = {1 - c.x - c.y - c.z, c.x, c.y, c.z};
  });
}

void Model::prefer_unknowns(std::uint32_t body_slot) {
  Body& body = bodies[body_slot];
  if (body.first_solid == none || body.count == body.rank) return;
  std::uint32_t needs = 0;
  bool outside = false, in_shape = true;
  for_each_particle_of(body_slot, [&](std::uint32_t p) {
    if (!is_needed(particles[p])) return;
    ++needs;
    outside = outside || particles[p].basis_index < 0;
    in_shape = in_shape && follows_basis(p);
  });
  // Decided once for each number of needs, so that it does not depend on when somebody looks.
  if (needs == body.basis_needs) return;
  body.basis_needs = needs;
  double extent = 0;
  for (int row = 0; row < body.row_count; ++row) {
    const auto [i, j] = basis_pairs[row];
    extent = std::max(extent, body.lengths[row]);
    const double gap = norm(position(body.basis[j]) - position(body.basis[i])) - body.lengths[row];
    in_shape = in_shape && std::abs(gap) < 1e-9 * extent;
  }
  if (!outside || !in_shape) return;
  grips.for_each([&](std::uint32_t, Grip& g) {  // they hang on basis points
    if (g.body != body_slot) return;
    const Vec3 point = grip_point(*this, g);
    rebuild_basis(body_slot);
    anchor_grip(*this, g, point);
  });
  rebuild_basis(body_slot);
}

}  // namespace iota::model
