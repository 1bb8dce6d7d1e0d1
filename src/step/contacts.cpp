// SPDX-License-Identifier: Apache-2.0
#include "step/contacts.h"

#include "model/solid.h"

#include <algorithm>
#include <optional>
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

bool is_particle(const model::Body& body, const contact::Outlines& outlines, std::uint32_t slot) {
  return body.count == 1 && outlines.described(slot).solids.empty();
}

/// Whether it has an outline with a material now.
bool may_touch(const model::Model& model, const contact::Outlines& outlines, std::uint32_t slot) {
  return model.bodies[slot].kind != BodyKind::inactive && outlines.reach(slot) >= 0 && model.material(slot);
}

}  // namespace

double ContactFinder::Obstacle::distance(const Vec3& place) const {
  return is_half_space ? dot(normal, place - origin) : geometry::distance(box, place);
}

void ContactFinder::list_obstacles(model::Model& model, contact::Outlines& outlines) {
  obstacles_.clear();
  model.materials.for_each([&](std::uint32_t body, const Material&) {
    if (model.bodies[body].kind != BodyKind::static_ || !outlines.has(body) || !model.material(body)) return;
    const contact::Outline& outline = outlines.placed(body);
    const bool is_sensor = model.material(body)->touches == Touches::sensor;
    Obstacle obstacle{body, contact::bounds(outline), false, is_sensor, {}, {}};
    if (outline.solids.size() == 1 && outline.lines.empty())
      if (const auto* const half = std::get_if<HalfSpace>(&outline.solids[0].form->shape)) {
        obstacle.is_half_space = true, obstacle.origin = outline.solids[0].position;
        obstacle.normal = rotate(outline.solids[0].turn, (1 / norm(half->normal)) * half->normal);
      }
    obstacles_.push_back(obstacle);
  });
  std::sort(obstacles_.begin(), obstacles_.end(), [](const Obstacle& a, const Obstacle& b) { return a.body < b.body; });
}

ContactFinder::Mover ContactFinder::mover_at(const model::Model& model, const contact::Outlines& outlines,
                                             std::uint32_t slot) {
  const model::Body& body = model.bodies[slot];
  Mover mover{slot, is_particle(body, outlines, slot), outlines.reach(slot), model.position(body.first), {}, 0};
  for (std::size_t k = 0; k < body.rank; ++k) mover.velocity += (1.0 / body.rank) * model.velocity(body.basis[k]);
  for (std::size_t k = 0; k < body.rank; ++k)
    mover.spread = std::max(mover.spread, norm(model.velocity(body.basis[k]) - mover.velocity));
  return mover;
}

// Resting ones are looked at only where one of the others comes near.
void ContactFinder::list_movers(model::Model& model, const contact::Outlines& outlines) {
  movers_.clear();
  is_any_extended_ = false;
  model.bodies.for_each([&](std::uint32_t slot, const model::Body& body) {
    if (body.kind == BodyKind::static_) return;
    if (!may_touch(model, outlines, slot)) return ingredient::Contacts::end(model, slot);
    is_any_extended_ = is_any_extended_ || !is_particle(body, outlines, slot);
    if (body.kind != BodyKind::resting) movers_.push_back(mover_at(model, outlines, slot));
  });
}

double ContactFinder::within(const Mover& mover, const Mover* other) const {
  const Vec3 relative = other ? mover.velocity - other->velocity : mover.velocity;
  const double speed = norm(relative) + mover.spread + (other ? other->spread : 0) + fall_;
  return of_way * h_ * speed + of_size * (other ? std::min(mover.reach, other->reach) : mover.reach);
}

// Few obstacles are looked at one by one.
void ContactFinder::find_obstacles(const model::Model& model) {
  for (const Mover& mover : movers_) {
    const bool is_scripted = model.bodies[mover.body].kind == BodyKind::scripted;
    const double reach = mover.reach + within(mover, nullptr);
    for (const Obstacle& obstacle : obstacles_)
      if ((!is_scripted || obstacle.is_sensor) && obstacle.distance(mover.place) <= reach)
        pairs_.push_back({mover.body, obstacle.body});
  }
}

// Particles alone do not touch each other: see are_plain.
void ContactFinder::find_pairs(const model::Model& model, contact::Outlines& outlines) {
  if (movers_.empty() || !is_any_extended_) return;
  const contact::OutlineTree& tree = outlines.refresh(model.step);
  for (const Mover& mover : movers_) {
    const double more = within(mover, nullptr);
    geometry::Bounds box = contact::bounds(tree[mover.body]);
    box.low -= Vec3{more, more, more}, box.high += Vec3{more, more, more};
    tree.overlapping(box, [&](std::uint32_t body) {
      if (body == mover.body || model.bodies[body].kind == BodyKind::static_ || !may_touch(model, outlines, body))
        return;
      const Mover other = mover_at(model, outlines, body);
      if (norm(other.place - mover.place) > mover.reach + other.reach + within(mover, &other)) return;
      pairs_.push_back({std::min(body, mover.body), std::max(body, mover.body)});
    });
  }
}

namespace {

/// Whether a hinge or a joint holds one at the other.
bool are_joined(const model::Model& model, std::uint32_t a, std::uint32_t b) {
  const auto [fewer, other] = model.bodies[a].count <= model.bodies[b].count ? std::pair(a, b) : std::pair(b, a);
  bool any = false;
  model.for_each_particle_of(fewer, [&](std::uint32_t p) {
    const model::Particle& particle = model.particles[p];
    if (any) return;
    if (model.rings[particle.ring].count > 1)
      model.for_each_in_ring(particle.ring, [&](std::uint32_t q) { any = any || model.particles[q].body == other; });
    if (particle.uses > 0) any = any || ingredient::Joints::join(model, p, other);
  });
  return any;
}

/// Two particles do not touch, unless they have materials of their own.
bool are_plain(const model::Model& model, std::uint32_t a, std::uint32_t b) {
  return !model.materials.has(a) || !model.materials.has(b);
}

}  // namespace

void ContactFinder::find(model::Model& model, contact::Outlines& outlines, double h) {
  if (model.materials.is_empty() && !model.has_usual_material && model.contacts.size() == 0) return;
  outlines.describe();
  h_ = h, fall_ = h * norm(model.acting_gravity());
  pairs_.clear(), sensed_.clear();
  list_obstacles(model, outlines);
  list_movers(model, outlines);
  find_obstacles(model);
  find_pairs(model, outlines);
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  for (const Pair& pair : pairs_) touch(model, outlines, pair);
  if (model.contacts.size() > 0)
    for (const Mover& mover : movers_) ingredient::Contacts::end_old(model, mover.body);
}

void ContactFinder::sense(const model::Model& model, contact::Outlines& outlines, const Pair& pair) {
  constexpr double close = 1e-3;  // of the size
  const auto [first, second] = pair;
  const bool are_both = model.material(first)->touches == model.material(second)->touches;
  if (are_both || ingredient::IgnoredContacts::include(model, first, second) || are_joined(model, first, second))
    return;
  const Mover mover = mover_at(model, outlines, first);
  const bool is_fixed = model.bodies[second].kind == BodyKind::static_;
  const Vec3 other_velocity = is_fixed ? Vec3{} : mover_at(model, outlines, second).velocity;
  found_.clear();
  const contact::Outline& outline = outlines.placed(first);
  if (!is_fixed) (void)outlines.placed(second);
  touches_.find(outline, {}, outlines.described(second), {}, close * mover.reach, found_);
  if (found_.empty()) return;
  const contact::Touch& deepest =
      *std::min_element(found_.begin(), found_.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; });
  const Vec3 normal = (deepest.is_turned ? -1.0 : 1.0) * deepest.normal;
  const double speed = std::max(0.0, -dot(mover.velocity - other_velocity, normal));
  sensed_.push_back({first, second, deepest.place, normal, deepest.gap, speed});
}

void ContactFinder::touch(model::Model& model, contact::Outlines& outlines, const Pair& pair) {
  const auto [first, second] = pair;
  if (model.material(first)->touches == Touches::sensor || model.material(second)->touches == Touches::sensor)
    return sense(model, outlines, pair);
  const Mover mover = mover_at(model, outlines, first);
  std::optional<Mover> other;
  if (model.bodies[second].kind != BodyKind::static_) other = mover_at(model, outlines, second);
  const auto touches = [&](std::uint32_t body) { return model.material(body)->touches; };
  if (other && (touches(first) != Touches::all || touches(second) != Touches::all)) return;
  if (other && mover.is_ball && other->is_ball && are_plain(model, first, second)) return;
  if (other && !model::is_free(model.bodies[first].kind) && !model::is_free(model.bodies[second].kind)) return;
  if (ingredient::IgnoredContacts::include(model, first, second)) return;
  if (are_joined(model, first, second)) return;
  // Only a body with three dimensions carries a spin.
  const auto spin = [&](std::uint32_t body) {
    return model.bodies[body].rank == 4 ? model::body_angular_velocity(model, body) : Vec3{};
  };
  const Vec3 spins[2] = {spin(first), other ? spin(second) : Vec3{}};
  const double size = other ? std::min(mover.reach, other->reach) : mover.reach;
  found_.clear();
  const contact::Outline& outline = outlines.placed(first);
  if (other) (void)outlines.placed(second);
  const Vec3 way = h_ * (other ? mover.velocity - other->velocity : mover.velocity);
  touches_.find(outline, spins[0], outlines.described(second), spins[1], within(mover, other ? &*other : nullptr),
                found_, way);
  keep_the_outermost(found_, size);
  ingredient::Contacts::take(model, first, second, found_, {size, {spins[0], spins[1]}, h_});
}

}  // namespace iota::step
