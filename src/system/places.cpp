// SPDX-License-Identifier: Apache-2.0
#include "contact/outline.h"
#include "shape/shape.h"
#include "system/core.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace iota {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_place(const Vec3& place) {
  if (!is_finite(place)) throw std::invalid_argument("the place must be finite");
}

}  // namespace

template <class Search, class Visit>
void Places::for_each(const Only& only, Search search, Visit visit) {
  const contact::OutlineTree& bodies = core_.outlines.refresh(core_.model.step);
  const auto visit_body = [&](std::uint32_t slot, const contact::Outline& outline) {
    return visit(core_.model.bodies.id(slot), outline);
  };
  if (only) {
    for (const BodyId id : *only)
      if (const std::uint32_t slot = core_.slot(id); bodies.has(slot)) (void)visit_body(slot, bodies[slot]);
    return;
  }
  search(bodies, visit_body);
}

std::optional<Hit> Places::ray(const Vec3& from, const Vec3& direction, double farthest, Only only) {
  require_place(from);
  const double length = norm(direction);
  if (!(length > 0 && is_finite(direction))) throw std::invalid_argument("the direction of a ray must not be zero");
  const Vec3 unit = (1 / length) * direction;
  std::optional<Hit> first;
  for_each(
      only, [&](const contact::OutlineTree& tree, auto visit) { tree.along(from, unit, farthest, visit); },
      [&](BodyId body, const contact::Outline& outline) {
        const std::optional<double> met = meet(outline, from, unit, farthest);
        if (met && (!first || *met < farthest || body.slot < first->body.slot)) {
          farthest = *met;
          first = Hit{body, from + *met * unit, *met};
        }
        return farthest;
      });
  return first;
}

std::optional<Hit> Places::nearest(const Vec3& place, Only only) {
  require_place(place);
  std::optional<Hit> best;
  // Within a body it may be deeper in another one.
  const auto limit = [&] { return best ? std::max(best->distance, 0.0) : infinity; };
  for_each(
      only, [&](const contact::OutlineTree& tree, auto visit) { tree.near(place, limit(), visit); },
      [&](BodyId body, const contact::Outline& outline) {
        const auto [distance, point] = near(outline, place);
        const double least = best ? best->distance : infinity;
        if (distance < least || (best && distance == least && body.slot < best->body.slot))
          best = Hit{body, point, distance};
        return limit();
      });
  return best;
}

std::vector<BodyId> Places::within(const Vec3& place, double radius, Only only) {
  require_place(place);
  if (!(radius >= 0)) throw std::invalid_argument("the radius must be 0 m or more, not " + std::to_string(radius));
  std::vector<BodyId> found;
  for_each(
      only, [&](const contact::OutlineTree& tree, auto visit) { tree.near(place, radius, visit); },
      [&](BodyId body, const contact::Outline& outline) {
        if (near(outline, place).distance <= radius) found.push_back(body);
        return radius;
      });
  std::ranges::sort(found, {}, &BodyId::slot);
  return found;
}

std::vector<BodyId> Places::overlap(const Shape& shape, const Vec3& position, const Quaternion& orientation,
                                    Only only) {
  require_place(position);
  shape::check(shape);
  if (!contact::is_convex(shape) || !shape::is_solid(shape))
    throw std::invalid_argument("only a convex shape can be asked about, as a box, a sphere or a capsule; not a " +
                                std::string(shape::name(shape)));
  const contact::Solid probe{contact::make_form(shape), 0, position, orientation};
  const geometry::Bounds box = contact::bounds({{probe}, {}});
  const Vec3 middle = 0.5 * (box.low + box.high);
  const double reach = 0.5 * norm(box.high - box.low);
  std::vector<BodyId> found;
  for_each(
      only, [&](const contact::OutlineTree& tree, auto visit) { tree.near(middle, reach, visit); },
      [&](BodyId body, const contact::Outline& outline) {
        if (is_overlapped(outline, probe)) found.push_back(body);
        return reach;
      });
  std::ranges::sort(found, {}, &BodyId::slot);
  return found;
}

}  // namespace iota
