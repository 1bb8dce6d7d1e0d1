// SPDX-License-Identifier: Apache-2.0
#include "contact/gap.h"
#include "contact/outline.h"
#include "contact/polytope.h"
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

Vec3 unit_of(const Vec3& direction) {
  const double length = norm(direction);
  if (!(length > 0 && is_finite(direction))) throw std::invalid_argument("the direction of a ray must not be zero");
  return (1 / length) * direction;
}

/// A convex shape at a place, in a ball.
struct Probe {
  contact::Solid solid;
  Vec3 middle;
  double reach;
};

Probe make_probe(const Shape& shape, const Vec3& position, const Quaternion& orientation) {
  require_place(position);
  shape::check(shape);
  const auto* const mesh = std::get_if<Mesh>(&shape);
  if (mesh ? !contact::try_polytope(*mesh) : !contact::is_convex(shape) || !shape::is_solid(shape))
    throw std::invalid_argument("only a convex shape can be asked about, as a box, a sphere or a capsule; not a " +
                                std::string(mesh ? "mesh that is not convex" : shape::name(shape)));
  contact::Solid solid{contact::make_form(shape), 0, position, orientation};
  const geometry::Bounds& box = solid.form->box;
  const Vec3 middle = position + rotate(orientation, 0.5 * (box.low + box.high));
  const double reach = 0.5 * norm(box.high - box.low);
  return {std::move(solid), middle, reach};
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

template <class Meet>
std::optional<Hit> Places::find_first(const Only& only, const Vec3& from, const Vec3& unit, double width,
                                      double farthest, Meet meet) {
  if (!(farthest >= 0)) throw std::invalid_argument("farthest must be 0 m or more, not " + std::to_string(farthest));
  std::optional<Hit> first;
  for_each(
      only, [&](const contact::OutlineTree& tree, auto visit) { tree.along(from, unit, width, farthest, visit); },
      [&](BodyId body, const contact::Outline& outline) {
        const std::optional<contact::Cast> met = meet(outline, farthest);
        if (met && (!first || met->distance < farthest || body.slot < first->body.slot)) {
          farthest = met->distance;
          first = Hit{body, met->point, met->distance};
        }
        return farthest;
      });
  return first;
}

std::optional<Hit> Places::ray(const Vec3& from, const Vec3& direction, double farthest, Only only) {
  require_place(from);
  const Vec3 unit = unit_of(direction);
  return find_first(only, from, unit, 0, farthest, [&](const contact::Outline& outline, double limit) {
    const std::optional<double> met = meet(outline, from, unit, limit);
    return met ? std::optional(contact::Cast{*met, from + *met * unit}) : std::nullopt;
  });
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
  const auto [probe, middle, reach] = make_probe(shape, position, orientation);
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

std::optional<Hit> Places::cast(const Shape& shape, const Vec3& position, const Quaternion& orientation,
                                const Vec3& direction, double farthest, Only only) {
  const auto [probe, middle, reach] = make_probe(shape, position, orientation);
  const Vec3 unit = unit_of(direction);
  const contact::Solid& solid = probe;  // C++20 lambdas of older compilers capture no structured bindings
  return find_first(only, middle, unit, reach, farthest, [&](const contact::Outline& outline, double limit) {
    return contact::cast(outline, solid, unit, limit);
  });
}

Gap Places::gap(BodyId body, BodyId other) {
  const contact::OutlineTree& bodies = core_.outlines.refresh(core_.model.step);
  const std::uint32_t one = core_.slot(body), two = core_.slot(other);
  if (one == two) throw std::invalid_argument("a gap is between two bodies, not of one with itself");
  if (!bodies.has(one) || !bodies.has(two)) throw std::invalid_argument("sparks have no outline, and no gaps");
  const contact::Gap found = contact::gap(bodies[one], bodies[two]);
  return {found.distance, found.on_first, found.on_second};
}

}  // namespace iota
