// SPDX-License-Identifier: Apache-2.0
// Parts that touch or overlap are pulled apart along a direction until the points that are nearest to each other are well
// defined; these give the next direction. It stays the same where the separation is stationary.
#include "contact/round_axis.h"

#include "contact/closest.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::contact {

namespace {

constexpr double clearly_apart = 1e-3;  ///< of the size: the direction is that of the distance
constexpr std::size_t most_guessed_faces = 64;
constexpr double pulled_apart = 0.02;                                   ///< of the size
constexpr double settled_direction = 1e-7, settled_separation = 1e-11;  ///< the latter of the size
constexpr double shrunk = 0.9, rough = 1e-6;
constexpr int most_pulls = 20;
constexpr double exact_pull = 1e-13;  ///< of the squared distance: the direction is then right to 1e-6

Closest closest_of(const ConvexPart& first, const ConvexPart& second, const Vec3& shift, const Vec3& start,
                   double exactness, double scale = 1) {
  const auto of = [&](const ConvexPart& part, const Vec3& direction) {
    const Vec3 place = farthest(part, direction);
    return scale == 1 ? place : part.middle + scale * (place - part.middle);
  };
  const auto of_first = [&](const Vec3& direction) { return Support{of(first, direction) + shift}; };
  const auto of_second = [&](const Vec3& direction) { return Support{of(second, direction)}; };
  return closest(of_first, of_second, start, exactness);
}

/// The best of the normals of flat faces, and of the directions between axes and middles.
Vec3 guess(const ConvexPart& first, const ConvexPart& second, double& most) {
  Vec3 best;
  most = -std::numeric_limits<double>::infinity();
  const auto look = [&](const Vec3& normal) {
    const double apart = apart_along(first, second, normal);
    if (apart > most) most = apart, best = normal;
  };
  const auto look_at_faces = [&](const ConvexPart& part, double sign) {
    const std::size_t count = part.kind == ConvexPart::Kind::cylinder     ? 2
                              : part.kind == ConvexPart::Kind::cone       ? 1
                              : part.normals.size() <= most_guessed_faces ? part.normals.size()
                                                                          : 0;
    for (std::size_t f = 0; f < count; ++f) look(sign * part.normals[f]);
  };
  look_at_faces(second, 1), look_at_faces(first, -1);
  Vec3 between = first.middle - second.middle;
  for (const ConvexPart* const part : {&first, &second}) {
    if (norm(between) > 0) look((1 / norm(between)) * between);
    if (part->kind == ConvexPart::Kind::cylinder || part->kind == ConvexPart::Kind::cone)
      between -= dot(between, part->axes[0]) * part->axes[0];
  }
  if (norm(between) > 0) look((1 / norm(between)) * between);
  if (!(norm(best) > 0)) look({0, 1, 0});  // one in the other
  return best;
}

}  // namespace

double apart_along(const ConvexPart& first, const ConvexPart& second, const Vec3& normal) {
  return dot(normal, farthest(first, -normal) - farthest(second, normal));
}

RoundAxis guess_round_axis(const ConvexPart& first, const ConvexPart& second) {
  double most = 0;
  const Vec3 normal = guess(first, second, most);
  return {normal, most, farthest(first, -normal), farthest(second, normal)};
}

std::optional<RoundAxis> find_round_axis(const ConvexPart& first, const ConvexPart& second, const RoundAxis& guessed,
                                         double limit) {
  const double size = std::min(first.size, second.size);
  const Vec3 start = guessed.normal;
  const double most = guessed.apart;
  RoundAxis best = guessed;
  Closest found;
  if (most > clearly_apart * size ||
      (found = closest_of(first, second, {}, start, 1e-15)).distance > clearly_apart * size) {
    if (found.distance == 0) found = closest_of(first, second, {}, start, 1e-15);
    const double apart = apart_along(first, second, found.normal);
    if (apart > limit) return {};
    if (apart > 0) return RoundAxis{found.normal, apart, found.on_first, found.on_second};
  }
  Vec3 normal = start;
  double apart = most;
  if (!(found.distance > 0)) found = closest_of(first, second, {}, start, rough, shrunk);
  if (found.distance > 0) normal = found.normal, apart = apart_along(first, second, normal);
  for (int pull = 0; pull < most_pulls; ++pull) {
    const Vec3 shift = (pulled_apart * size - apart) * normal;
    found = closest_of(first, second, shift, normal, exact_pull);
    if (!(found.distance > 0)) break;
    const Vec3 next = found.normal;
    const double change = norm(next - normal), former = apart;
    normal = next, apart = apart_along(first, second, normal);
    if (pull == 0 || apart > best.apart) best = {normal, apart, found.on_first - shift, found.on_second};
    if (change <= settled_direction || (pull > 1 && std::abs(apart - former) <= settled_separation * size)) break;
  }
  if (best.apart < most) best.normal = start, best.apart = most;
  if (best.apart > limit) return {};
  return best;
}

}  // namespace iota::contact
