// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"
#include "model/basis_weights.h"
#include "model/restructure.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace iota::model {

namespace {

// Below this many particles a basis is chosen again at each change, which takes microseconds.
constexpr std::uint32_t large = 64;

/// The extent up to which a body counts as a point, m: the round-off of places, or 2e-6 (see strained_gap) of what is hinged to it. No step
/// resolves how it turns there: a link of 1e-8 m stopped a chain of 0.1 m. A solid needs points apart for its pose.
double size_of_point(const Structure& model, std::uint32_t body_slot) {
  constexpr double of_neighbors = 2e-6, of_place = 1e-15;
  const Body& body = model.bodies[body_slot];
  if (body.first_solid != none || body.count > large) return 0;
  double largest = 0;
  model.for_each_particle_of(body_slot, [&](std::uint32_t p) {
    const std::uint32_t ring = model.particles[p].ring;
    if (model.rings[ring].count == 1) return;
    model.for_each_in_ring(ring, [&](std::uint32_t other) {
      if (model.particles[other].body != body_slot)
        largest = std::max(largest, model.extent(model.particles[other].body));
    });
  });
  return std::max(of_neighbors * largest, of_place * norm(model.position(body.first)));
}

/// Distance of r (relative to the first basis point) from the span of `axes` orthonormal directions.
double distance_from_span(Vec3 r, const std::array<Vec3, 3>& axes, int count) {
  for (int i = 0; i < count; ++i) r -= dot(r, axes[i]) * axes[i];
  return norm(r);
}

}  // namespace

// The first massive particle, then thrice the massive particle farthest from the span so far: well-conditioned, and for a rod simply its
// two ends. All other points are affine combinations of these. A body made of solids prefers points that are unknowns
// anyway, if they reach a fifth as far. Of equal ones the first is chosen, independent of round-off. Markers have no
// mass and cannot be in a basis.
void Structure::rebuild_basis(std::uint32_t body_slot) {
  constexpr double flat = 1e-7;  // of the extent: thinner counts as a point, line or plane
  constexpr double equal = 1 + 1e-6, far_enough = 0.2;
  Body& body = bodies[body_slot];
  note_body(body_slot);
  const std::array<std::uint32_t, 4> old_basis = body.basis;
  body.rank = 0, body.row_count = 0, body.basis_needs = 0;
  body.basis.fill(none);
  if (body.count == 0) return more_rows.erase(body_slot);

  const auto is_preferred = [&](std::uint32_t p) {
    return body.first_solid != none && is_needed(particles[p]) && !particles[p].is_marker();
  };
  std::uint32_t first = none;
  for_each_particle_of(body_slot, [&](std::uint32_t p) {
    if (is_preferred(p) ? body.basis_needs++ == 0 : first == none && !particles[p].is_marker()) first = p;
  });
  if (first == none) return more_rows.erase(body_slot);
  body.basis[body.rank++] = first;
  const Vec3 origin = position(first);
  std::array<Vec3, 3> axes;
  double extent = 0;
  for (int dimension = 0; dimension < 3; ++dimension) {
    std::uint32_t farthest = none, preferred = none;
    double distance = 0, preferred_distance = 0;
    for_each_particle_of(body_slot, [&](std::uint32_t p) {
      if (particles[p].is_marker()) return;
      const double d = distance_from_span(position(p) - origin, axes, dimension);
      if (d > equal * distance) distance = d, farthest = p;
      if (d > equal * preferred_distance && is_preferred(p)) preferred_distance = d, preferred = p;
    });
    if (dimension == 0) extent = distance;
    if (farthest == none || !(distance > (dimension == 0 ? size_of_point(*this, body_slot) : flat * extent))) break;
    if (preferred != none && preferred_distance > far_enough * distance) farthest = preferred;
    Vec3 axis = position(farthest) - origin;
    for (int i = 0; i < dimension; ++i) axis -= dot(axis, axes[i]) * axes[i];
    axes[dimension] = (1 / norm(axis)) * axis;
    body.basis[body.rank++] = farthest;
  }

  body.row_count = static_cast<std::uint8_t>(body.rank * (body.rank - 1) / 2);
  if (body.row_count > 1)
    (void)more_rows.make(body_slot);
  else
    more_rows.erase(body_slot);
  for (int row = 0; row < body.row_count; ++row) {
    const auto [i, j] = basis_pairs[row];
    RigidRow& rigid = this->row(body_slot, row);
    rigid.length = norm(position(body.basis[j]) - position(body.basis[i]));
    if (old_basis != body.basis) rigid.multiplier = 0;  // not those of other rows
  }

  std::optional<BasisWeights> weights;  // for bodies with more points than their basis
  for_each_particle_of(body_slot, [&](std::uint32_t p) {
    Particle& particle = particles[p];
    particle.basis_index = -1;
    for (std::int8_t i = 0; i < body.rank; ++i)
      if (body.basis[static_cast<std::size_t>(i)] == p) particle.basis_index = i;
    if (particle.basis_index >= 0) return affine.erase(p);
    if (!weights) weights.emplace(*this, body_slot);
    affine.make(p) = {weights->of(position(p)), {}};
  });
  keep_inertia_positive(body_slot);
}

bool carry_by_basis(Structure& model, std::uint32_t body_slot, std::uint32_t before,
                    std::span<const std::uint32_t> particles) {
  constexpr double far = 1.5;  // of the basis' lengths: places farther out amplify its round-off
  const Body& body = model.bodies[body_slot];
  if (before < large || body.rank < 2) return false;
  const BasisWeights weights(model, body_slot);
  const double flat = 1e-9 * model.extent(body_slot);
  std::vector<AffineParticle> found;
  for (const std::uint32_t p : particles) {
    AffineParticle affine{weights.of(model.position(p)), {}};
    Vec3 carried;
    for (int i = 0; i < body.rank; ++i) {
      if (!(std::abs(affine.weights[i]) < far)) return false;
      carried += affine.weights[i] * model.position(body.basis[i]);
    }
    if (norm(carried - model.position(p)) > flat) return false;
    found.push_back(affine);
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    model.particles[particles[i]].basis_index = -1;
    model.affine.make(particles[i]) = found[i];
  }
  model.note_body(body_slot);
  return true;
}

bool keeps_basis(const Structure& model, std::uint32_t body_slot) {
  const Body& body = model.bodies[body_slot];
  if (body.count < large || body.rank == 0) return false;
  for (int i = 0; i < body.rank; ++i) {
    const std::uint32_t p = body.basis[i];
    if (!model.particles.is_alive(p) || model.particles[p].body != body_slot || model.particles[p].basis_index != i)
      return false;
  }
  return true;
}

// Rods have less inertia than point masses at their ends: a negative pair. With less mass at an end than the rod had
// (assigned, or shared with a copy), some motions would have negative kinetic energy. If each mass is above twice the
// sum of its pairs, as in a rod, the matrix is diagonally dominant with any hinges or affine particles.
void Structure::keep_inertia_positive(std::uint32_t body_slot) {
  std::vector<std::pair<std::uint32_t, double>> taken;  // by each pair from both of its ends
  for_each_inertia_of(body_slot, [&](std::uint32_t i) {
    const InertiaPair& pair = inertia_pairs[i];
    if (!(pair.inertia < 0)) return;
    taken.push_back({pair.p, -pair.inertia});
    taken.push_back({pair.q, -pair.inertia});
  });
  std::sort(taken.begin(), taken.end());
  for (std::size_t i = 0; i < taken.size();) {
    const std::uint32_t particle = taken[i].first;
    double sum = 0;
    for (; i < taken.size() && taken[i].first == particle; ++i) sum += taken[i].second;
    if (!(particles[particle].mass > 2.001 * sum)) remove_inertia_of(body_slot, particle);
  }
  inertia_changed(body_slot);
}

void Structure::prefer_unknowns(std::uint32_t body_slot) {
  Body& body = bodies[body_slot];
  if (body.rank > 1 && extent(body_slot) <= size_of_point(*this, body_slot)) return rebuild_basis(body_slot);
  if (body.first_solid == none || body.count == body.rank) return;
  std::uint32_t needs = 0;
  bool outside = false, in_shape = true;
  for_each_particle_of(body_slot, [&](std::uint32_t p) {
    if (!is_needed(particles[p])) return;
    in_shape = in_shape && follows_basis(p);  // also for a marker that was just combined, which would keep its place
    if (particles[p].is_marker()) return;
    ++needs;
    outside = outside || particles[p].basis_index < 0;
  });
  // Decided once for each number of needs, so that the result does not depend on when this is called.
  if (needs == body.basis_needs) return;
  body.basis_needs = needs;
  double longest = 0;
  for (int k = 0; k < body.row_count; ++k) {
    const auto [i, j] = basis_pairs[k];
    const double length = row(body_slot, k).length;
    longest = std::max(longest, length);
    in_shape = in_shape && std::abs(norm(position(body.basis[j]) - position(body.basis[i])) - length) < 1e-9 * longest;
  }
  if (!outside || !in_shape) return;
  rebuild_basis(body_slot);
}

std::uint32_t Structure::make_marker(std::uint32_t body, const Vec3& position) {
  const std::uint32_t marker = make_particle(body, position, 0, {});
  affine.make(marker).weights = BasisWeights(*this, body).of(position);
  Ring& ring = rings[particles[marker].ring];
  std::tie(ring.position, ring.velocity) = carried(marker);
  mark_body(body);
  return marker;
}

double Structure::extent(std::uint32_t body) const {
  double longest = 0;
  for (int k = 0; k < bodies[body].row_count; ++k) longest = std::max(longest, row(body, k).length);
  return longest;
}

std::array<double, 4> Structure::weights(std::uint32_t particle) const {
  const int own = particles[particle].basis_index;
  if (own < 0) return affine[particle].weights;
  std::array<double, 4> weights{};
  weights[static_cast<std::size_t>(own)] = 1;
  return weights;
}

std::pair<Vec3, Vec3> Structure::carried(std::uint32_t particle) const {
  const Body& body = bodies[particles[particle].body];
  const std::array<double, 4> w = weights(particle);
  Vec3 x, v;
  for (int i = 0; i < body.rank; ++i) {
    const Ring& b = rings[particles[body.basis[i]].ring];
    x += w[i] * b.position;
    v += w[i] * b.velocity;
  }
  return {x, v};
}

bool Structure::follows_basis(std::uint32_t particle) const {
  if (particles[particle].basis_index >= 0) return true;
  constexpr double round_off = 1e-9, of_places = 1e-15;
  const Body& body = bodies[particles[particle].body];
  double speed = norm(velocity(particle));
  for (int i = 0; i < body.rank; ++i) speed = std::max(speed, norm(rings[particles[body.basis[i]].ring].velocity));
  const auto [x, v] = carried(particle);
  return norm(x - position(particle)) <= round_off * extent(particles[particle].body) + of_places * norm(x) &&
         norm(v - velocity(particle)) <= round_off * speed;
}

BodyId Structure::part_at(std::uint32_t body, const Vec3& place) const {
  BodyId part = bodies.id(body);
  double least = -1;
  for_each_particle_of(body, [&](std::uint32_t p) {
    const double distance = norm(position(p) - place);
    if (particles[p].is_marker() || (least >= 0 && distance >= least)) return;
    least = distance, part = particles[p].part;
  });
  return part;
}

bool Structure::spans(std::uint32_t body_slot, const Vec3& place) const {
  constexpr double off = 1e-6;  // of the extent: largest distance of a place on the body's point, line or plane
  const Body& body = bodies[body_slot];
  if (body.rank == 0) return false;
  const double longest = extent(body_slot);
  const std::array<double, 4> weights = BasisWeights(*this, body_slot).of(place);
  Vec3 nearest;
  for (int i = 0; i < body.rank; ++i) nearest += weights[i] * position(body.basis[i]);
  return norm(nearest - place) <= off * (longest > 0 ? std::max(longest, norm(place - position(body.basis[0]))) : 1e-3);
}

}  // namespace iota::model
