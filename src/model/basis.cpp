// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"
#include "model/model.h"

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
// two ends. Everything else is an affine combination of these.
void Model::rebuild_basis(std::uint32_t body_slot) {
  constexpr double flat = 1e-7;  // of the extent: thinner counts as a point, line or plane
  Body& body = bodies[body_slot];
  const std::array<std::uint32_t, 4> old_basis = body.basis;
  body.rank = 0, body.row_count = 0;
  body.basis.fill(none);
  if (body.count == 0) return;

  body.basis[body.rank++] = body.first;
  const Vec3 origin = position(body.first);
  std::array<Vec3, 3> axes;
  double extent = 0;
  for (int dimension = 0; dimension < 3; ++dimension) {
    std::uint32_t farthest = none;
    double distance = 0;
    for_each_particle_of(body_slot, [&](std::uint32_t p) {
      const double d = distance_from_span(position(p) - origin, axes, dimension);
      if (d > distance) distance = d, farthest = p;
    });
    if (dimension == 0) extent = distance;
    if (farthest == none || !(distance > flat * extent)) break;
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

}  // namespace iota::model
