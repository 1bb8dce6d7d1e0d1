// SPDX-License-Identifier: Apache-2.0
#include "contact/rims.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iota::contact {

namespace {

constexpr std::uint32_t of_rims = 9u << 28, grid = 96;  ///< numbers of features
/// A load so near to the middle is well within the fixed points, of the radius.
constexpr double well_within = 0.7;
/// Between two touches of fixed points nothing of the rim is beyond the other body, as a cosine of their turn.
constexpr double least_cosine = 0.45;

/// At a place of the grid, if the rim has fixed points on both sides of it, and none there.
std::optional<Touch> touch_at(std::uint32_t place, std::span<const Touch> touches, const Touch& one) {
  constexpr double same = 1e-6;
  const Rim& rim = *one.rim;
  const double turn = 2 * std::numbers::pi * place / grid, squared = dot(rim.first, rim.first);
  const Vec3 out = std::cos(turn) * rim.first + std::sin(turn) * rim.second, axis = cross(rim.first, rim.second);
  bool is_before = false, is_after = false;
  const Touch* nearest = nullptr;
  double most = least_cosine * squared;
  for (const Touch& touch : touches) {
    if (!are_on_one_rim(touch, one)) continue;
    const Vec3 other = touch.center - rim.middle;
    const double along = dot(out, other), side = dot(cross(out, other), axis);
    if (!(along > least_cosine * squared)) continue;
    is_before = is_before || side <= 0, is_after = is_after || side >= 0;
    if (along > most) most = along, nearest = &touch;
  }
  if (!is_before || !is_after || most > (1 - same) * squared) return {};
  Touch touch = *nearest;
  (touch.is_turned ? touch.other_feature : touch.feature) = of_rims + grid * rim.name + place;
  const Vec3 way = rim.middle + out - touch.center;
  touch.center += way, touch.place += way;
  touch.gap = dot(touch.normal, touch.center - touch.origin) - touch.radius;
  return touch;
}

}  // namespace

bool are_on_one_rim(const Touch& a, const Touch& b) {
  return a.rim && b.rim && a.rim->name == b.rim->name && a.is_turned == b.is_turned && a.part == b.part &&
         a.other_part == b.other_part && (a.is_turned ? a.feature == b.feature : a.other_feature == b.other_feature);
}

void PointsOfRim::add_beside(const Vec3& load) {
  const Rim& rim = *one_.rim;
  const double squared = dot(rim.first, rim.first), x = dot(load, rim.first), y = dot(load, rim.second);
  if (!(squared > 0) || !(std::hypot(x, y) > well_within * squared)) return;
  const double at = std::floor(std::atan2(y, x) / (2 * std::numbers::pi) * grid);
  const auto place = static_cast<std::uint32_t>(at + grid) % grid;
  add(place), add((place + 1) % grid);
}

void PointsOfRim::add_again(std::uint32_t feature) {
  const std::uint32_t first = of_rims + grid * one_.rim->name;
  if (feature >= first && feature < first + grid) add(feature - first);
}

void PointsOfRim::add(std::uint32_t place) {
  const std::uint32_t name = of_rims + grid * one_.rim->name + place;
  const bool is_known = std::ranges::any_of(added_, [&](const Touch& touch) {
    return are_on_one_rim(touch, one_) && (touch.is_turned ? touch.other_feature : touch.feature) == name;
  });
  if (is_known) return;
  if (const std::optional<Touch> touch = touch_at(place, touches_, one_)) added_.push_back(*touch);
}

}  // namespace iota::contact
