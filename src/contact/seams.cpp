// SPDX-License-Identifier: Apache-2.0
#include "contact/seams.h"

#include "math/mat3.h"

#include <algorithm>

namespace iota::contact {

namespace {

constexpr double flush = 1e-5;        ///< of the size: a part that is so much higher is a step
constexpr double beside = 1e-3;       ///< of the size: a gap between two parts that is as good as none
constexpr double same_cosine = 1e-6;  ///< below 1, of normals that count as the same

/// Not less than how far it reaches along a direction, from a place.
double reach_along(const Solid& solid, const Vec3& direction, const Vec3& place) {
  const Vec3 along = rotate(conjugate(solid.turn), direction);
  const auto& [low, high] = solid.form->box;
  return dot(direction, solid.position - place) + std::max(along.x * low.x, along.x * high.x) +
         std::max(along.y * low.y, along.y * high.y) + std::max(along.z * low.z, along.z * high.z);
}

bool is_at(const Solid& solid, const Vec3& place, double tolerance) {
  const Vec3 here = to_local(solid, place);
  return is_within(*solid.form, here) || norm(here - closest(*solid.form, here)) <= tolerance;
}

/// Touches of corners do not tell of which part the plane is.
const Solid* solid_of(const Outline& obstacle, std::uint32_t part, const Vec3& place, double tolerance) {
  const auto& solids = obstacle.solids;
  auto found = solids.size() == 1 ? solids.begin() : std::ranges::find(solids, part, &Solid::number);
  if (found == solids.end())
    found = std::ranges::find_if(solids, [&](const Solid& solid) { return is_at(solid, place, tolerance); });
  return found == solids.end() ? nullptr : &*found;
}

void find_plane(TouchOfPart& of, double size) {
  const Touch& touch = of.touch;
  const bool has_plane = touch.is_turned == of.is_first;
  of.place = has_plane ? touch.place - touch.gap * touch.normal : touch.place;
  of.normal = has_plane ? touch.normal : -1.0 * touch.normal;
  of.solid = solid_of(*of.obstacle, of.is_first ? touch.part : touch.other_part, of.place, flush * size);
}

/// Whether what touches along the plane of one cannot come to the place of the other but along this plane.
bool covers(const TouchOfPart& one, const TouchOfPart& other, double size) {
  if (one.solid == other.solid || !one.solid || !other.solid || other.solid->form->is_endless) return false;
  if (!(dot(one.normal, other.place - one.place) <= flush * size)) return false;
  if (other.touch.form == TouchForm::face && dot(one.normal, other.normal) > 1 - same_cosine) return false;
  return is_at(*one.solid, other.place, beside * size) &&
         reach_along(*other.solid, one.normal, one.place) <= flush * size;
}

}  // namespace

void drop_seams(std::vector<TouchOfPart>& touches, double size, std::vector<Seam>& seams) {
  for (TouchOfPart& each : touches) find_plane(each, size);
  const auto is_of_first = [&](const TouchOfPart& each) { return each.solid == touches.front().solid; };
  if (std::ranges::all_of(touches, is_of_first)) return;
  for (std::size_t k = touches.size(); k-- > 0;) {
    const auto cover =
        std::ranges::find_if(touches, [&](const TouchOfPart& one) { return covers(one, touches[k], size); });
    if (cover == touches.end()) continue;
    seams.push_back({touches[k].obstacle, cover->normal});
    touches.erase(touches.begin() + static_cast<std::ptrdiff_t>(k));
  }
}

}  // namespace iota::contact
