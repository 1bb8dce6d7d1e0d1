// SPDX-License-Identifier: Apache-2.0
#include "step/contacts.h"

#include "model/solid.h"

#include <algorithm>
#include <variant>

namespace iota::step {

namespace {

constexpr double of_way = 1.5;    ///< a body that speeds up goes further than it would
constexpr double of_size = 0.02;  ///< what it may turn further

/// A body lies on the outermost ones of many points: the lowest one, and those that are farthest from the ones before.
void keep_the_outermost(std::vector<contact::Touch>& touches, double size) {
  constexpr std::size_t most = 12;
  constexpr double of_gap = 4;  // a point is as good as one that is lower by a quarter of the way to it
  if (touches.size() <= most) return;
  std::swap(touches.front(), *std::min_element(touches.begin(), touches.end(),
                                               [](const auto& a, const auto& b) { return a.gap < b.gap; }));
  const auto worth = [&](const contact::Touch& touch, std::size_t count) {
    double least = size;
    for (std::size_t i = 0; i < count; ++i) least = std::min(least, norm(touch.place - touches[i].place));
    return least - of_gap * (touch.gap - touches.front().gap);
  };
  for (std::size_t count = 1; count < most; ++count) {
    std::size_t best = count;
    for (std::size_t i = count + 1; i < touches.size(); ++i)
      if (worth(touches[i], count) > worth(touches[best], count)) best = i;
    std::swap(touches[count], touches[best]);
  }
  touches.resize(most);
}

}  // namespace

double ContactFinder::Obstacle::distance(const Vec3& place) const {
  return is_half_space ? dot(normal, place - origin) : geometry::distance(box, place);
}

void ContactFinder::list_obstacles(model::Model& model, contact::Outlines& outlines) {
  obstacles_.clear();
  model.materials.for_each([&](std::uint32_t body, const Material&) {
    if (model.bodies[body].kind != BodyKind::static_ || !outlines.has(body)) return;
    const contact::Outline& outline = outlines.placed(body);
    Obstacle obstacle{body, contact::bounds(outline), false, {}, {}};
    if (outline.solids.size() == 1 && outline.lines.empty())
      if (const auto* const half = std::get_if<HalfSpace>(&outline.solids[0].form->shape)) {
        obstacle.is_half_space = true, obstacle.origin = outline.solids[0].position;
        obstacle.normal = rotate(outline.solids[0].turn, (1 / norm(half->normal)) * half->normal);
      }
    obstacles_.push_back(obstacle);
  });
  std::sort(obstacles_.begin(), obstacles_.end(), [](const Obstacle& a, const Obstacle& b) { return a.body < b.body; });
}

void ContactFinder::find(model::Model& model, contact::Outlines& outlines, double h) {
  if (model.materials.is_empty() && model.contacts.size() == 0) return;
  outlines.describe();
  list_obstacles(model, outlines);
  model.bodies.for_each([&](std::uint32_t body, const model::Body& b) {
    if (b.kind == BodyKind::resting) return;
    if (b.kind == BodyKind::dynamic && model.material(body) && outlines.reach(body) >= 0)
      find_of(model, outlines, body, h);
    else
      ingredient::Contacts::end(model, body);
  });
}

void ContactFinder::find_of(model::Model& model, contact::Outlines& outlines, std::uint32_t slot, double h) {
  const model::Body& body = model.bodies[slot];
  const Vec3 place = model.position(body.first);
  const double reach = outlines.reach(slot);
  double speed = 0;
  for (std::size_t k = 0; k < body.rank; ++k) speed = std::max(speed, norm(model.velocity(body.basis[k])));
  const double within = of_way * h * (speed + h * norm(model.acting_gravity())) + of_size * reach;
  Vec3 spin;
  near_.clear(), all_.clear();
  for (const Obstacle& obstacle : obstacles_)
    if (obstacle.distance(place) <= reach + within && model.bodies[obstacle.body].articulate != body.articulate)
      near_.push_back(obstacle.body);
  if (!near_.empty()) {
    const contact::Outline& outline = outlines.placed(slot);
    spin = body.rank == 4 ? model::body_angular_velocity(model, slot) : Vec3{};  // others cannot carry it
    for (const std::uint32_t other : near_) {
      found_.clear();
      touches_.find(outline, spin, outlines.described(other), within, found_);
      keep_the_outermost(found_, reach);
      for (const contact::Touch& touch : found_) all_.push_back({other, touch});
    }
  }
  if (!all_.empty() || model.contacts.has_any(slot)) ingredient::Contacts::take(model, slot, all_, {reach, spin, h});
}

}  // namespace iota::step
