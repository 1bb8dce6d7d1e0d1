// SPDX-License-Identifier: Apache-2.0
#include "model/outline.h"

#include <iota/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace iota::model {

namespace {

constexpr double ball_share = 2;  ///< the radius of a single particle, in usual radii

/// The length of a body of two massive particles with one line between them.
std::optional<double> rod_length(const Structure& structure, std::uint32_t body) {
  const Body& b = structure.bodies[body];
  if (b.first_solid != none || b.count < 2) return std::nullopt;
  int massive = 0, lines = 0;
  double length = 0;
  structure.for_each_particle_of(body, [&](std::uint32_t p) { massive += !structure.particles[p].is_marker(); });
  if (massive != 2) return std::nullopt;
  structure.visit_lines(body, [&](std::uint32_t p, std::uint32_t q) {
    ++lines, length = norm(structure.position(q) - structure.position(p));
  });
  return lines == 1 ? std::optional(length) : std::nullopt;
}

/// Nothing if no body has a particle, apart from sparks.
std::optional<double> expected_radius(const Structure& structure) {
  std::vector<double> rods;
  bool has_bodies = false;
  structure.bodies.for_each([&](std::uint32_t body, const Body& b) {
    if (b.count == 0 || structure.is_spark(b.first)) return;
    has_bodies = true;
    if (const std::optional<double> length = rod_length(structure, body)) rods.push_back(*length);
  });
  if (!has_bodies) return std::nullopt;
  return usual_radius_of(std::move(rods), scene_extent(structure));
}

}  // namespace

double scene_extent(const Structure& structure) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Vec3 low{far, far, far}, high{-far, -far, -far};
  structure.rings.for_each([&](std::uint32_t, const Ring& ring) {
    const Vec3& r = ring.position;
    low = {std::min(low.x, r.x), std::min(low.y, r.y), std::min(low.z, r.z)};
    high = {std::max(high.x, r.x), std::max(high.y, r.y), std::max(high.z, r.z)};
  });
  return structure.rings.size() > 0 ? norm(high - low) : 0;
}

double usual_radius(Structure& structure) {
  if (structure.usual_radius > 0) return structure.usual_radius;
  Structure::ExpectedRadius& expected = structure.expected_radius;
  if (expected.value > 0 && expected.edits == structure.edits && expected.version == structure.structure_version)
    return expected.value;
  expected = {structure.edits, structure.structure_version,
              expected_radius(structure).value_or(usual_radius_of({}, 0))};
  return expected.value;
}

void choose_usual_radius(Structure& structure) {
  if (structure.usual_radius == 0) structure.usual_radius = expected_radius(structure).value_or(0);
}

double radius_of(Structure& structure, std::uint32_t body) {
  const Body& b = structure.bodies[body];
  if (b.first_solid != none) return 0;
  if (b.count == 1)
    if (const double own = structure.ball_radius(b.first); own > 0) return own;
  if (const double* const own = structure.radii.find(body)) return *own;
  return (b.count == 1 ? ball_share : 1) * usual_radius(structure);
}

void set_radius(Structure& structure, std::uint32_t body, double radius) {
  const Body& b = structure.bodies[body];
  if (b.count == 1 && structure.ball_radius(b.first) > 0)
    structure.attributes[structure.particles[b.first].attributes].radius = radius;
  else
    structure.radii.make(body) = radius;
  structure.note_body(body);
}

}  // namespace iota::model

namespace iota {

double usual_radius_of(std::vector<double> rods, double extent) {
  std::erase_if(rods, [](double length) { return !std::isfinite(length); });
  constexpr double of_rods = 0.06, of_extent = 0.02, otherwise = 0.03;
  const auto middle = rods.begin() + static_cast<std::ptrdiff_t>(rods.size() / 2);
  std::ranges::nth_element(rods, middle);
  if (middle != rods.end() && *middle > 0) return of_rods * *middle;
  return extent > 0 && std::isfinite(extent) ? of_extent * extent : otherwise;
}

}  // namespace iota
