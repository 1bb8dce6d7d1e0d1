// SPDX-License-Identifier: Apache-2.0
#include "step/contacts.h"

#include "base/sort_unique.h"
#include "ingredient/contact_readings.h"
#include "model/outline.h"
#include "model/solid.h"
#include "solver/heap.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

namespace iota::step {

namespace {

constexpr double of_way = 1.5;             ///< a body that speeds up goes further than it would
constexpr std::size_t few_obstacles = 16;  ///< are looked at one by one
constexpr double touching = 1e-3;          ///< of what passes a sensor
/// A body whose points have not gone further, of its size, keeps its contacts: they are places of both bodies, and a plane that turns
/// with one. A body of a heap, whose last step sweeps have solved, may go further: its places are not known any better.
constexpr double standing = 1e-5, standing_in_heap = 1e-3;

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

std::span<const std::uint32_t> ContactFinder::Known::of(const model::Model& model, const Pair& pair) {
  if (pair.first != body_) look(model, pair.first);
  const auto begin = std::lower_bound(items_.begin(), items_.end(), std::pair(pair.second, std::uint32_t{0}));
  auto end = begin;
  while (end != items_.end() && end->first == pair.second) ++end;
  return std::span(slots_).subspan(static_cast<std::size_t>(begin - items_.begin()),
                                   static_cast<std::size_t>(end - begin));
}

void ContactFinder::Known::look(const model::Model& model, std::uint32_t body) {
  body_ = body;
  items_.clear(), slots_.clear();
  if (model.contacts.size() > 0)
    model.contacts.for_each_of(body, [&](std::uint32_t slot) {
      const auto& c = model.contacts[slot];
      items_.push_back({c.p == body ? c.q : c.p, slot});
    });
  std::sort(items_.begin(), items_.end());
  for (const auto& [other, slot] : items_) slots_.push_back(slot);
}

double ContactFinder::Obstacle::distance(const Vec3& place) const {
  return is_half_space ? dot(normal, place - origin) : geometry::distance(box, place);
}

const ContactFinder::Obstacle& ContactFinder::obstacle_at(const model::Model& model, contact::Outlines& outlines,
                                                          std::uint32_t body) {
  if (all_obstacles_.size() <= body) all_obstacles_.resize(model.bodies.slot_count());
  Obstacle& obstacle = all_obstacles_[body];
  if (obstacle.look == look_) return obstacle;
  const contact::Outline& outline = outlines.placed(body);
  obstacle = {
      .look = look_, .box = contact::bounds(outline), .is_sensor = model.material(body)->touches == Touches::sensor};
  if (outline.solids.size() == 1 && outline.lines.empty())
    if (const auto* const half = std::get_if<HalfSpace>(&outline.solids[0].form->shape)) {
      obstacle.is_half_space = true, obstacle.origin = outline.solids[0].position;
      obstacle.normal = rotate(outline.solids[0].turn, (1 / norm(half->normal)) * half->normal);
    }
  return obstacle;
}

void ContactFinder::set_length(const model::Model& model, double h) {
  h_ = h, fall_ = h * norm(model.acting_gravity());
}

void ContactFinder::begin_look(const model::Model& model, double h, bool are_placed) {
  are_placed_ = are_placed;
  set_length(model, h);
  ++look_;
  if (all_movers_.size() < model.bodies.slot_count()) all_movers_.resize(model.bodies.slot_count());
}

namespace {

/// The acceleration by what is known before the step: forces that were applied, fields, and hands. A ball at rest that was pushed by
/// more than its size in a step went through walls.
double acceleration_by_others(const model::Model& model, std::uint32_t slot) {
  double sum = 0;
  if (!model.pushes.is_empty()) {
    Vec3 force;
    model.for_each_particle_of(slot, [&](std::uint32_t p) {
      if (const ingredient::Push* const push = model.pushes.find(model.particles[p].ring)) force += push->force;
    });
    if (force != Vec3{}) sum += norm(force) / model.body_mass(slot);
  }
  model.grips.for_each_of(slot, [&](std::uint32_t, const ingredient::Grip& grip) {
    const double distance = norm(grip.target - ingredient::Grips::point(model, grip));
    sum += grip.stiffness_at(distance) * distance;
  });
  return sum;
}

/// The speed that a script gives a body in a step of h seconds beside that of the step before, m/s.
double calc_jump(const model::Model& model, const model::Body& body, double h) {
  double most = 0;
  for (std::size_t k = 0; k < body.rank; ++k) {
    const std::uint32_t ring = model.particles[body.basis[k]].ring;
    if (!model.rings[ring].nailed) continue;
    const ingredient::Nail& nail = model.nails.at(ring);
    most = std::max(most, norm((1 / h) * (nail.position - nail.position_before) - model.rings[ring].velocity));
  }
  return most;
}

}  // namespace

ContactFinder::Mover& ContactFinder::mover_at(const model::Model& model, contact::Outlines& outlines,
                                              std::uint32_t slot) {
  Mover& mover = all_movers_[slot];
  if (mover.look == look_) return mover;
  const model::Body& body = model.bodies[slot];
  // A particle reaches as far wherever it is, and most of them touch nothing.
  const bool has_extent = body.count > 1 || body.first_solid != model::none;
  if (has_extent && !are_placed_) (void)outlines.placed(slot);
  mover = {.body = slot,
           .reach = outlines.reach(slot),
           .place = model.position(body.first),
           .look = look_,
           .is_placed = are_placed_ || has_extent};
  for (std::size_t k = 0; k < body.rank; ++k) mover.velocity += (1.0 / body.rank) * model.velocity(body.basis[k]);
  for (std::size_t k = 0; k < body.rank; ++k)
    mover.spread = std::max(mover.spread, norm(model.velocity(body.basis[k]) - mover.velocity));
  if (model::is_free(body.kind)) mover.thrust = h_ * acceleration_by_others(model, slot);
  if (body.kind == BodyKind::scripted) mover.jump = calc_jump(model, body, step_);
  const std::uint32_t stride = ingredient::Strides::of(model, slot);
  mover.steps = stride == ingredient::Strides::frozen ? 1 : stride;
  return mover;
}

// Pairs that may touch change with outlines and materials. A body with a new one is described anew.
void ContactFinder::note_changes(model::Model& model, contact::Outlines& outlines) {
  const auto look_at = [&](std::uint32_t slot, const model::Body& body) {
    if (model.material(slot) && outlines.has(slot)) touches_.prepare(outlines.described(slot));
    if (!model.material(slot)) return ingredient::Contacts::end(model, slot);
    if (body.kind == BodyKind::static_) return;
    if (!may_touch(model, outlines, slot)) return ingredient::Contacts::end(model, slot);
    is_any_extended_ = is_any_extended_ || !is_particle(body, outlines, slot) || model.materials.has(slot);
  };
  const Touches usual = model.has_usual_material ? model.usual_material.touches : Touches::nothing;
  if (std::exchange(usually_touches_, usual) != usual) {
    model.bodies.for_each([&](std::uint32_t slot, const model::Body& body) { look_at(slot, body); });
    listed_at_ = {};
  } else {
    for (const std::uint32_t slot : outlines.described())
      if (model.bodies.is_alive(slot)) look_at(slot, model.bodies[slot]);
  }
  outlines.forget_described();
}

namespace {

/// Bodies that an edit wakes are looked at in the same step: with the contacts from before it a box stayed for a step on a floor that was
/// gone.
bool is_asleep(const model::Model& model, std::uint32_t slot) {
  const model::Body& body = model.bodies[slot];
  return body.kind == BodyKind::resting && !model.articulates[body.articulate].to_wake;
}

}  // namespace

// Sleepers look for nothing, and nor do static bodies: a wall that was put into a sleeping box stayed in it.
void ContactFinder::wake_at_edited_obstacles(model::Model& model, contact::Outlines& outlines) {
  // By index: what is woken is listed at the end.
  for (std::size_t i = 0; i < model.flagged().size(); ++i) {
    const std::uint32_t articulate = model.flagged()[i];
    if (!model.articulates.is_alive(articulate)) continue;
    const std::uint32_t obstacle = model.articulates[articulate].first;
    if (model.bodies[obstacle].kind != BodyKind::static_ || !model.material(obstacle) || !outlines.has(obstacle))
      continue;
    const contact::OutlineTree& tree = outlines.refresh(model.step);
    tree.overlapping(contact::bounds(tree[obstacle]), [&](std::uint32_t body) {
      const Pair pair{std::min(body, obstacle), std::max(body, obstacle)};
      if (is_asleep(model, body) && may_touch(model, outlines, body) &&
          touch_each_other(model, outlines, joined_, pair))
        model.wake(model.bodies[body].articulate);
    });
  }
}

// A look at each of ten thousand sleepers takes a tenth of a millisecond.
void ContactFinder::list_candidates(const model::Model& model, const contact::Outlines& outlines,
                                    std::uint64_t awake_version) {
  const std::array<std::uint64_t, 3> now{awake_version + 1, model.edits, outlines.lists_version()};
  if (listed_at_ == now && model.flagged().empty()) return;
  listed_at_ = now;
  obstacles_.clear(), candidates_.clear();
  std::ranges::copy_if(outlines.fixed(), std::back_inserter(obstacles_),
                       [&](std::uint32_t body) { return model.material(body) != nullptr; });
  std::ranges::copy_if(outlines.movable(), std::back_inserter(candidates_),
                       [&](std::uint32_t slot) { return !is_asleep(model, slot) && may_touch(model, outlines, slot); });
}

// Resting ones are looked at only where one of the others comes near.
void ContactFinder::list_movers(const model::Model& model) {
  movers_.clear();
  std::ranges::copy_if(candidates_, std::back_inserter(movers_), [&](std::uint32_t slot) {
    return !is_asleep(model, slot) && !ingredient::Strides::skips(model, slot);
  });
}

double ContactFinder::within(const Mover& mover, const Mover* other, double steps) const {
  const Vec3 relative = other ? mover.velocity - other->velocity : mover.velocity;
  const double thrust = mover.thrust + (other ? other->thrust : 0);
  const double speed = norm(relative) + mover.spread + (other ? other->spread : 0) + steps * (fall_ + thrust);
  const double thrown = mover.thrown + (other ? other->thrown : 0);
  return of_way * steps * h_ * speed + thrown + of_size * (other ? std::min(mover.reach, other->reach) : mover.reach);
}

double ContactFinder::way_of_jump(double jump) const { return of_way * h_ * jump; }

// Each axis has its own speed: a swing past a post is none towards it. It turns less than a stride may.
geometry::Bounds ContactFinder::way_of_stride(const model::Model& model, contact::Outlines& outlines,
                                              const Mover& mover) const {
  constexpr double sideways = 0.35;  // of the way of a point on its arc
  const model::Body& body = model.bodies[mover.body];
  Vec3 most = sideways * mover.spread * Vec3{1, 1, 1};
  const Vec3 gravity = model.acting_gravity();
  const double time = of_way * mover.steps * h_;
  for (double Vec3::* const axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    double fastest = 0;
    for (std::size_t k = 0; k < body.rank; ++k)
      fastest = std::max(fastest, std::abs(model.velocity(body.basis[k]).*axis));
    most.*axis += fastest + mover.steps * (std::abs(h_ * gravity.*axis) + mover.thrust);
  }
  const Vec3 way = time * most + of_size * mover.reach * Vec3{1, 1, 1};
  geometry::Bounds box = contact::bounds(outlines.placed(mover.body));
  box.low -= way, box.high += way;
  return box;
}

// Few obstacles are looked at one by one, many by the tree. What hangs on a beam may take strides.
void ContactFinder::find_obstacles(model::Model& model, contact::Outlines& outlines) {
  if (movers_.empty() || obstacles_.empty()) return;
  const contact::OutlineTree* const tree = obstacles_.size() > few_obstacles ? &outlines.refresh(model.step) : nullptr;
  for (const std::uint32_t slot : movers_) {
    const Mover& mover = mover_at(model, outlines, slot);
    const bool is_scripted = model.bodies[mover.body].kind == BodyKind::scripted;
    const double reach = mover.reach + within(mover, nullptr);
    const double reach_of_stride = mover.steps > 1 ? mover.reach + within(mover, nullptr, mover.steps) : reach;
    const double jump = way_of_jump(mover.jump);
    const auto is_in_the_way = [&](const Obstacle& obstacle) {
      return obstacle.is_half_space || geometry::overlap(way_of_stride(model, outlines, mover), obstacle.box);
    };
    const auto look_at = [&](std::uint32_t body) {
      const Obstacle& obstacle = obstacle_at(model, outlines, body);
      if (is_scripted && !obstacle.is_sensor) return;
      const double distance = obstacle.distance(mover.place);
      if (distance <= (obstacle.is_sensor ? reach + jump : reach)) pairs_.push_back({mover.body, body});
      if (mover.steps > 1 && distance <= reach_of_stride && is_in_the_way(obstacle) &&
          touch_each_other(model, outlines, joined_, {mover.body, body}))
        ingredient::Strides::note_near(model, mover.body);
    };
    if (!tree) {
      for (const std::uint32_t body : obstacles_) look_at(body);
      continue;
    }
    const Vec3 most = (reach_of_stride + jump) * Vec3{1, 1, 1};
    tree->overlapping({mover.place - most, mover.place + most}, [&](std::uint32_t body) {
      if (model.bodies[body].kind == BodyKind::static_ && model.material(body)) look_at(body);
    });
  }
}

// Plain particles alone do not touch each other.
void ContactFinder::find_pairs(model::Model& model, contact::Outlines& outlines) {
  if (movers_.empty() || !is_any_extended_) return;
  const contact::OutlineTree& tree = outlines.refresh(model.step);
  const auto box_of = [&](Mover& mover) -> const geometry::Bounds& {
    if (!mover.box) mover.box = contact::bounds(tree[mover.body]);
    return *mover.box;
  };
  const auto look_at = [&](std::uint32_t body) -> Mover* {
    if (all_movers_[body].look == look_) return &all_movers_[body];
    if (model.bodies[body].kind == BodyKind::static_ || !may_touch(model, outlines, body)) return nullptr;
    return &mover_at(model, outlines, body);
  };
  // The other one may come as fast; then it looks for this one, too, but not as far as both go together.
  for (const std::uint32_t slot : movers_) {
    Mover& mover = mover_at(model, outlines, slot);
    const double own = within(mover, nullptr, mover.steps);
    mover.ahead = own > far * mover.reach ? 2 * own : own;
  }
  // A pair is found once, by the one that looks farther.
  const auto is_plain = [](const Mover& mover) { return mover.ahead >= 0 && mover.jump == 0 && mover.steps == 1; };
  for (const std::uint32_t slot : movers_) {
    Mover& mover = mover_at(model, outlines, slot);
    const geometry::Bounds box = geometry::grown(box_of(mover), mover.ahead);
    const geometry::Bounds box_of_jump = geometry::grown(box, way_of_jump(mover.jump));
    tree.overlapping(box_of_jump, [&](std::uint32_t body) {
      Mover* const other = body == slot ? nullptr : look_at(body);
      if (!other) return;
      if (is_plain(mover) && is_plain(*other) &&
          (other->ahead > mover.ahead || (other->ahead == mover.ahead && body < slot)))
        return;
      const double apart = norm(other->place - mover.place) - mover.reach - other->reach;
      const Pair pair{std::min(body, slot), std::max(body, slot)};
      const bool jumps = mover.jump + other->jump > 0 && is_sensor(model, pair);
      const bool is_near = apart <= within(mover, other) + (jumps ? way_of_jump(mover.jump + other->jump) : 0);
      const bool may_be_met = mover.steps > 1 && model.bodies[body].articulate != model.bodies[slot].articulate &&
                              apart <= within(mover, other, mover.steps);
      if (!is_near && !may_be_met) return;
      // The boxes of the tree are wider than the outlines, by their history, which a restored system does not have.
      if (!geometry::overlap(jumps ? box_of_jump : box, box_of(*other))) return;
      if (may_be_met && touch_each_other(model, outlines, joined_, pair)) ingredient::Strides::note_near(model, slot);
      if (is_near) pairs_.push_back(pair);
    });
  }
}

void ContactFinder::list_pairs(model::Model& model, contact::Outlines& outlines) {
  find_obstacles(model, outlines);
  find_pairs(model, outlines);
  sort_unique(pairs_);
  std::erase_if(pairs_, [&](const Pair& pair) { return !touch_each_other(model, outlines, joined_, pair); });
}

bool ContactFinder::may_find_any(const model::Model& model) {
  return !model.materials.is_empty() || model.has_usual_material || model.contacts.size() > 0;
}

void ContactFinder::find(model::Model& model, contact::Outlines& outlines, double h, std::uint64_t awake_version) {
  hasty_.clear(), sensed_.clear(), passing_.clear(), thrown_.clear(), passed_.clear();
  joined_.forget();
  first_look_ = look_ + 1;
  if (!may_find_any(model)) return;
  outlines.describe();
  step_ = h, shortest_ = h / solver::Heap::most_sub_steps;
  pairs_.clear();
  note_changes(model, outlines);
  wake_at_edited_obstacles(model, outlines);
  list_candidates(model, outlines, awake_version);
  list_movers(model);
  const bool has_many = is_any_extended_ || obstacles_.size() > few_obstacles;
  if (has_many && !movers_.empty()) (void)outlines.refresh(model.step);
  begin_look(model, h, has_many);
  list_pairs(model, outlines);
  known_.forget();
  for (const Pair& pair : pairs_) {
    if (is_sensor(model, pair)) {
      sense(model, outlines, pair);
      continue;
    }
    const Meeting meeting = meeting_of(model, outlines, pair);
    const Ahead ahead = look_ahead(model, outlines, pair, meeting);
    if (ahead.apart >= h) {
      passed_.push_back(pair);
      continue;
    }
    const auto touches = [&] {
      const std::span<const std::uint32_t> former = known_.of(model, pair);
      return renew(model, outlines, pair, meeting, former) || touch(model, outlines, pair, meeting, former);
    };
    const bool is_touching = !(ahead.apart > 0) && touches();
    if (is_touching && !(ahead.part < h)) note_touches(model, outlines, pair, meeting);
    if (!(ahead.part < h)) continue;
    note_impact(model, meeting, pair.second, meeting.speed() + fall_, true);
    if (!is_touching) ingredient::Contacts::tie(model, pair.first, pair.second);
    hasty_.push_back(model.bodies[pair.first].articulate);
  }
  look_around_thrown(model, outlines);
  if (model.contacts.size() > 0)
    for (const std::uint32_t slot : movers_) ingredient::Contacts::end_old(model, slot);
}

bool ContactFinder::is_watched(const model::Model& model, std::uint32_t body) const {
  return body < all_movers_.size() && all_movers_[body].look >= first_look_ && model::is_free(model.bodies[body].kind);
}

namespace {

/// The mean of the places that a moving body has as unknowns, m; zero for a static one.
Vec3 center_of(const model::Model& model, std::uint32_t slot) {
  const model::Body& body = model.bodies[slot];
  Vec3 center;
  if (body.kind != BodyKind::static_)
    for (std::size_t k = 0; k < body.rank; ++k) center += (1.0 / body.rank) * model.position(body.basis[k]);
  return center;
}

/// The deepest touch of two bodies; velocity: of the first relative to the second, m/s.
Sensed sensed_of(const std::pair<std::uint32_t, std::uint32_t>& pair, const std::vector<contact::Touch>& touches,
                 const Vec3& velocity) {
  const contact::Touch& deepest = *std::ranges::min_element(touches, {}, &contact::Touch::gap);
  const Vec3 normal = (deepest.is_turned ? -1.0 : 1.0) * deepest.normal;
  return {pair.first, pair.second, deepest.place, normal, deepest.gap, std::max(0.0, -dot(velocity, normal))};
}

}  // namespace

void ContactFinder::sense(const model::Model& model, contact::Outlines& outlines, const Pair& pair) {
  constexpr double close = 1e-3;  // of the size
  const auto [first, second] = pair;
  const Mover& mover = mover_at(model, outlines, first);
  const bool is_fixed = model.bodies[second].kind == BodyKind::static_;
  const Vec3 other_velocity = is_fixed ? Vec3{} : mover_at(model, outlines, second).velocity;
  found_.clear();
  const contact::Outline& outline = outlines.placed(first);
  if (!is_fixed) (void)outlines.placed(second);
  touches_.find(outline, {}, outlines.described(second), {}, close * mover.reach, found_);
  if (found_.empty()) {
    const Meeting meeting = meeting_of(model, outlines, pair);
    if (h_ * (meeting.speed() + meeting.jump()) > far * meeting.size)
      passing_.push_back({pair, meeting.size, {center_of(model, first), center_of(model, second)}});
    return;
  }
  sensed_.push_back(sensed_of(pair, found_, mover.velocity - other_velocity));
}

// By the places at both ends of the step: what was met before the sensor has kept it out.
void ContactFinder::sense_on_the_way(const model::Model& model, contact::Outlines& outlines, double h) {
  for (const auto& [pair, size, centers] : passing_) {
    const std::uint32_t bodies[2] = {pair.first, pair.second};
    contact::Motion motions[2];
    for (int k = 0; k < 2; ++k) {
      (void)outlines.placed(bodies[k]);
      motions[k] = motion_of(model, outlines, bodies[k]);
      motions[k].velocity = (1 / h) * (motions[k].center - centers[k]);
      motions[k].more = 0, motions[k].at = h;
    }
    const double close = touching * size;
    const double time = approaches_.time(outlines.described(pair.first), motions[0], outlines.described(pair.second),
                                         motions[1], close, h);
    if (!(time < h) || approaches_.met().empty()) continue;
    Sensed sensed = sensed_of(pair, approaches_.met(), motions[0].velocity - motions[1].velocity);
    if (!(sensed.gap <= close)) continue;
    sensed.position += motions[1].center, sensed.gap = 0, sensed.is_passed = true;
    sensed_.push_back(sensed);
  }
}

ContactFinder::Meeting ContactFinder::meeting_of(const model::Model& model, contact::Outlines& outlines,
                                                 const Pair& pair) {
  Meeting meeting{&mover_at(model, outlines, pair.first), nullptr, 0};
  if (model.bodies[pair.second].kind != BodyKind::static_) meeting.second = &mover_at(model, outlines, pair.second);
  meeting.size = meeting.second ? std::min(meeting.first->reach, meeting.second->reach) : meeting.first->reach;
  return meeting;
}

double ContactFinder::Meeting::speed() const {
  return second ? norm(first->velocity - second->velocity) + first->spread + second->spread
                : norm(first->velocity) + first->spread;
}

const contact::Outline& ContactFinder::placed(contact::Outlines& outlines, Mover& mover) {
  return std::exchange(mover.is_placed, true) ? outlines.described(mover.body) : outlines.placed(mover.body);
}

bool ContactFinder::is_of_sweeps(const model::Model& model, Mover* mover) {
  if (!mover) return false;
  if (!mover->of_sweeps) mover->of_sweeps = ingredient::Contacts::is_of_sweeps(model, mover->body);
  return *mover->of_sweeps;
}

bool ContactFinder::is_of_sweeps(const model::Model& model, const Meeting& meeting) {
  return is_of_sweeps(model, meeting.first) || is_of_sweeps(model, meeting.second);
}

// An edited body has no stand any more.
bool ContactFinder::has_moved(model::Model& model, const contact::Outlines& outlines, std::uint32_t slot,
                              double share) {
  if (all_moved_.size() <= slot) all_moved_.resize(model.bodies.slot_count());
  Moved& moved = all_moved_[slot];
  if (std::exchange(moved.look, look_) == look_) return moved.is;
  const model::Body& body = model.bodies[slot];
  const model::Stand* const before = model.stands.find(slot);
  model::Stand stand{.reach = outlines.reach(slot)};
  const double most = share * stand.reach;
  moved.is = !before || before->reach != stand.reach;
  for (std::size_t k = 0; k < std::min<std::size_t>(body.rank, stand.places.size()); ++k) {
    stand.places[k] = model.position(body.basis[k]);
    moved.is = moved.is || !(norm(stand.places[k] - before->places[k]) <= most);
  }
  if (moved.is) model.stands.make(slot) = stand;
  return moved.is;
}

// Nothing comes into reach of two bodies that stand: `within` is more than they go. Rods are found anew: ropes that creep about a beam did
// not converge with places of before.
bool ContactFinder::renew(model::Model& model, const contact::Outlines& outlines, const Pair& pair,
                          const Meeting& meeting, std::span<const std::uint32_t> former) {
  const auto is_solid = [&](std::uint32_t body) {
    return model.bodies[body].kind == BodyKind::static_ || model.bodies[body].rank == 4;
  };
  if (!is_solid(pair.first) || !is_solid(pair.second)) return false;
  const auto share_of = [&](Mover* mover) { return is_of_sweeps(model, mover) ? standing_in_heap : standing; };
  const double of_first = share_of(meeting.first), of_second = share_of(meeting.second);
  const bool has_first_moved = has_moved(model, outlines, pair.first, of_first),
             has_second_moved = has_moved(model, outlines, pair.second, of_second);
  if (has_first_moved || has_second_moved || !(h_ * meeting.speed() <= std::max(of_first, of_second) * meeting.size))
    return false;
  return ingredient::Contacts::renew(model, pair.first, pair.second, former, motion_in(model, meeting));
}

ingredient::Contacts::Motion ContactFinder::motion_in(const model::Model& model, const Meeting& meeting) const {
  // Only a body with three dimensions carries a spin.
  const auto spin = [&](Mover* of) {
    if (!of || model.bodies[of->body].rank != 4) return Vec3{};
    if (!of->spin) of->spin = model::body_angular_velocity(model, of->body);
    return *of->spin;
  };
  return {meeting.size, {spin(meeting.first), spin(meeting.second)}, h_, {}};
}

void ContactFinder::find_touches(const model::Model& model, contact::Outlines& outlines, const Pair& pair,
                                 const Meeting& meeting) {
  const auto [first, second] = pair;
  if (meeting.second) {
    find_touches_of_two(model, outlines, pair, meeting);
    for (const bool is_first : {false, true})
      if (const contact::Outline& obstacle = outlines.described(is_first ? first : second);
          obstacle.solids.size() > 1) {
        of_parts_.clear(), seams_.clear();
        for (const contact::Touch& touch : found_)
          of_parts_.push_back({.touch = touch, .obstacle = &obstacle, .is_first = is_first});
        contact::drop_seams(of_parts_, meeting.size, seams_);
        found_.clear();
        for (const auto& each : of_parts_) found_.push_back(each.touch);
      }
    return;
  }
  if (const std::pair now{look_, first}; std::exchange(looked_around_, now) != now)
    look_around(model, outlines, meeting);
  const contact::Outline* const obstacle = &outlines.described(second);
  found_.clear();
  for (const auto& each : around_)
    if (each.obstacle == obstacle) found_.push_back(each.touch);
}

// A seam of two obstacles is seen by the touches of the body with both.
void ContactFinder::look_around(const model::Model& model, contact::Outlines& outlines, const Meeting& meeting) {
  around_.clear();
  const std::uint32_t first = meeting.first->body;
  for (auto pair = std::lower_bound(pairs_.begin(), pairs_.end(), Pair{first, 0});
       pair != pairs_.end() && pair->first == first; ++pair) {
    if (model.bodies[pair->second].kind != BodyKind::static_ || is_sensor(model, *pair)) continue;
    find_touches_of_two(model, outlines, *pair, meeting);
    for (const contact::Touch& touch : found_)
      around_.push_back({.touch = touch, .obstacle = &outlines.described(pair->second)});
  }
  seams_.clear();
  contact::drop_seams(around_, meeting.size, seams_);
  add_faces_of_seams(model, outlines, meeting);
}

// Beyond its seam what lies on a face is on it, whatever else was nearer to its edge.
void ContactFinder::add_faces_of_seams(const model::Model& model, contact::Outlines& outlines, const Meeting& meeting) {
  const ingredient::Contacts::Motion motion = motion_in(model, meeting);
  for (auto seam = seams_.begin(); seam != seams_.end(); ++seam) {
    const auto is_same = [&](const contact::Seam& other) {
      return other.obstacle == seam->obstacle && other.normal == seam->normal;
    };
    const auto is_of = [&](const contact::TouchOfPart& known) { return known.obstacle == seam->obstacle; };
    if (std::any_of(seams_.begin(), seam, is_same) || std::ranges::any_of(around_, is_of)) continue;
    found_.clear();
    touches_.find_on_faces(placed(outlines, *meeting.first), (0.5 * h_) * motion.spins[0], *seam->obstacle, {},
                           seam->normal, within(*meeting.first, nullptr), found_);
    for (const contact::Touch& touch : found_) around_.push_back({.touch = touch, .obstacle = seam->obstacle});
  }
}

void ContactFinder::find_touches_of_two(const model::Model& model, contact::Outlines& outlines, const Pair& pair,
                                        const Meeting& meeting) {
  const auto& [mover, other, size] = meeting;
  const ingredient::Contacts::Motion motion = motion_in(model, meeting);
  found_.clear();
  const contact::Outline& outline = placed(outlines, *mover);
  if (other) (void)placed(outlines, *other);
  const Vec3 way = h_ * (other ? mover->velocity - other->velocity : mover->velocity);
  touches_.find(outline, (0.5 * h_) * motion.spins[0], outlines.described(pair.second), (0.5 * h_) * motion.spins[1],
                within(*mover, other), found_, way);
}

bool ContactFinder::touch(model::Model& model, contact::Outlines& outlines, const Pair& pair, const Meeting& meeting,
                          std::span<const std::uint32_t> former) {
  const auto [first, second] = pair;
  const auto& [mover, other, size] = meeting;
  const auto basis = [&](Mover* of) -> const model::BasisWeights* {
    if (!of) return nullptr;
    if (!of->basis) of->basis.emplace(model, of->body);
    return &*of->basis;
  };
  find_touches(model, outlines, pair, meeting);
  keep_the_outermost(found_, size);
  if (found_.empty()) return false;
  ingredient::Contacts::Motion motion = motion_in(model, meeting);
  motion.bases[0] = basis(mover), motion.bases[1] = basis(other);
  ingredient::Contacts::take(model, first, second, former, found_, motion);
  return true;
}

contact::Motion ContactFinder::motion_of(const model::Model& model, const contact::Outlines& outlines,
                                         std::uint32_t slot) const {
  const model::Body& body = model.bodies[slot];
  contact::Motion motion;
  if (body.kind == BodyKind::static_) return motion;
  motion.center = center_of(model, slot);
  for (std::size_t k = 0; k < body.rank; ++k) motion.velocity += (1.0 / body.rank) * model.velocity(body.basis[k]);
  motion.spin = model::body_angular_velocity(model, slot);
  motion.reach = contact::reach(outlines.described(slot), motion.center);
  motion.more = fall_;
  return motion;
}

}  // namespace iota::step
