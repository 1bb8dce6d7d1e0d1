// SPDX-License-Identifier: Apache-2.0
// Bodies that meet others on their way within a step: what springs and impacts throw, and steps that islands take in parts.
#include "base/sort_unique.h"
#include "ingredient/contact_readings.h"
#include "solver/heap.h"
#include "step/contacts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace iota::step {

namespace {

using solver::Heap;

constexpr double closing = 0.1;  ///< what comes closer in the rest of a step meets: the step is cut there
constexpr double near = 0.25;    ///< the way and the swing in a part in which bodies meet
/// Islands of sweeps take such parts in any case: their sub-steps are as many in all.
constexpr std::size_t most_in_parts = 2400;  ///< bodies in all parts of a step: larger islands take fewer
constexpr double near_in_sweeps = 0.1, still = 0.02;
constexpr double least = 1e-3;  ///< of the rest of a step: no part is shorter

}  // namespace

bool ContactFinder::is_beyond(const model::Model& model, std::uint32_t body, double beside) const {
  if (!is_watched(model, body)) return false;
  const Mover& mover = all_movers_[body];
  return beside > h_ * (fall_ + mover.thrust) + of_size * mover.reach;
}

// Pairs with contacts keep them.
bool ContactFinder::find_on_ways(model::Model& model, contact::Outlines& outlines,
                                 std::span<const std::uint32_t> bodies, bool is_part) {
  begin_look(model, h_, are_placed_);
  std::vector<Pair> known = std::exchange(pairs_, {});
  std::vector<std::uint32_t> movers;
  std::ranges::copy_if(bodies, std::back_inserter(movers), [&](std::uint32_t body) { return is_watched(model, body); });
  movers_.swap(movers);
  list_pairs(model, outlines);
  movers_.swap(movers);
  listed_.clear();
  if (is_part)
    list_pairs_of(model, outlines, bodies);
  else
    for (const Pair& pair : pairs_)
      if (!is_sensor(model, pair)) listed_.push_back({pair, meeting_of(model, outlines, pair)});
  known_.forget();
  bool any = false;
  for (const auto& [pair, meeting, apart] : listed_) {
    const std::span<const std::uint32_t> former = known_.of(model, pair);
    const bool has_any = std::ranges::any_of(former, [&](std::uint32_t slot) { return !model.contacts[slot].is_off; });
    if (!has_any && look_ahead(model, outlines, pair, meeting).apart < h_)
      any = touch(model, outlines, pair, meeting, former) || any;
  }
  pairs_.insert(pairs_.end(), known.begin(), known.end());
  sort_unique(pairs_);
  return any;
}

ContactFinder::Ahead ContactFinder::look_ahead(const model::Model& model, contact::Outlines& outlines, const Pair& pair,
                                               const Meeting& meeting) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const auto [first, second] = pair;
  const auto& [mover, other, size] = meeting;
  const double speed = meeting.speed();
  if (h_ * speed > near_in_sweeps * size && !(step_ * speed > Heap::most_sub_steps * far * size) &&
      is_of_sweeps(model, meeting))
    return {0, std::max(h_ / std::ceil(h_ * speed / (near_in_sweeps * size)), shortest_)};
  if (!(h_ * speed > far * size)) return {0, never};
  const contact::Outline& outline = placed(outlines, *mover);
  if (other) (void)placed(outlines, *other);
  contact::Motion motions[2] = {motion_of(model, outlines, first), motion_of(model, outlines, second)};
  motions[0].more += mover->thrust;
  if (other) motions[1].more += other->thrust;
  const contact::Outline& other_outline = outlines.described(second);
  const double time = approaches_.time(outline, motions[0], other_outline, motions[1], of_size * size, h_);
  if (time > least * h_) return {time, time};
  found_.clear();
  touches_.find(outline, {}, other_outline, {}, within(*mover, other), found_);
  const auto [approach, swing] = approach_of(motions, of_size * size);
  if (h_ * approach > closing * size) return {0, std::max(least * h_, near * size / speed)};
  if (h_ * swing > far * size) return {0, std::max(least * h_, near * size / swing)};
  return {0, never};
}

ContactFinder::Approach ContactFinder::approach_of(const contact::Motion (&motions)[2], double slack) const {
  Approach most;
  for (const contact::Touch& touch : found_) {
    const Vec3 swings[2] = {cross(motions[0].spin, touch.center - motions[0].center),
                            cross(motions[1].spin, touch.center - motions[1].center)};
    const Vec3 velocity = motions[0].velocity + swings[0] - motions[1].velocity - swings[1];
    const double turning = norm(swings[0]) + norm(swings[1]);
    const double each = (touch.is_turned ? 1.0 : -1.0) * dot(touch.normal, velocity);
    if (touch.gap <= slack + h_ * std::max(each, turning))
      most.speed = std::max(most.speed, each), most.swing = std::max(most.swing, turning);
  }
  return most;
}

void ContactFinder::note_touches(const model::Model& model, contact::Outlines& outlines, const Pair& pair,
                                 const Meeting& meeting) {
  if (!(h_ * meeting.speed() > of_size * meeting.size) || is_of_sweeps(model, meeting)) return;
  const contact::Motion motions[2] = {motion_of(model, outlines, pair.first), motion_of(model, outlines, pair.second)};
  const double fall = fall_ + meeting.first->thrust + (meeting.second ? meeting.second->thrust : 0);
  const double speed = approach_of(motions, of_size * meeting.size + h_ * fall).speed;
  if (speed > 0) note_impact(model, meeting, pair.second, speed + fall, false);
}

// By momentum and restitution. A body that is struck at its end moves there as if it had a quarter of its mass; one with joints may bring the
// momentum of others.
void ContactFinder::note_impact(const model::Model& model, const Meeting& meeting, std::uint32_t second, double speed,
                                bool is_hasty) {
  constexpr double at_end = 0.25;
  if (is_of_sweeps(model, meeting)) return;  // whose sub-steps look by themselves
  const std::uint32_t bodies[2] = {meeting.first->body, second};
  const auto restitution = [&](std::uint32_t body) { return model.material(body)->restitution; };
  const auto weighs_alone = [&](std::uint32_t body) {
    return model::is_free(model.bodies[body].kind) && model.articulates[model.bodies[body].articulate].count == 1;
  };
  const double change = (1 + std::max(restitution(bodies[0]), restitution(bodies[1]))) * speed;
  for (const bool k : {false, true}) {
    const std::uint32_t body = bodies[k], other = bodies[!k];
    if (!model::is_free(model.bodies[body].kind)) continue;
    const double own = at_end * model.body_mass(body), others = model.body_mass(other);
    const Mover* const mover = k ? meeting.first : meeting.second;  // the other one
    if (weighs_alone(other))
      thrown_.push_back({body, h_ * others / (own + others) * change, is_hasty});
    else
      thrown_.push_back({body, h_ * change, is_hasty, 0, change / speed, mover ? mover->velocity : Vec3{}});
  }
}

// By their velocities at the begin of the step bodies do not meet what an impact throws them at: a ball went through a plate behind it
// after it had bounced off a wall. What is thrown at a body may throw that one, too. Islands that take parts of the step look
// again in each part, and so need what they may meet among them, from the begin on.
void ContactFinder::look_around_thrown(model::Model& model, contact::Outlines& outlines) {
  if (thrown_.empty()) return;
  const contact::OutlineTree& tree = outlines.refresh(model.step);
  near_thrown_.clear();
  for (std::size_t k = 0; k < thrown_.size(); ++k) {
    const Thrown thrown = thrown_[k];
    Mover& mover = mover_at(model, outlines, thrown.body);
    if (!(thrown.reach > of_size * mover.reach)) continue;
    if (thrown.reach <= mover.thrown && (mover.is_hasty || !thrown.is_hasty)) continue;
    mover.thrown = std::max(mover.thrown, thrown.reach), mover.is_hasty = mover.is_hasty || thrown.is_hasty;
    const geometry::Bounds box = contact::bounds(placed(outlines, mover));
    Thrown all = thrown;
    all.reach = mover.thrown, all.is_hasty = mover.is_hasty;
    tree.overlapping(geometry::grown(box, mover.thrown), [&](std::uint32_t body) {
      const bool is_fixed = model.bodies[body].kind == BodyKind::static_;
      if (body == all.body || !(is_fixed ? model.material(body) != nullptr : may_touch(model, outlines, body))) return;
      const Pair pair = is_fixed ? Pair{all.body, body} : Pair{std::min(all.body, body), std::max(all.body, body)};
      if (is_sensor(model, pair) || !touch_each_other(model, outlines, joined_, pair)) return;
      const double gap = geometry::distance(box, contact::bounds(outlines.placed(body)));
      Thrown next = all;
      next.body = body, next.reach -= gap, next.crossed += gap;
      if (!(next.reach > 0)) return;
      near_thrown_.push_back(pair);
      if (!model::is_free(model.bodies[body].kind)) return;
      if (next.stop)
        next.reach = std::max(
            next.reach, h_ * next.bounce * norm(mover_at(model, outlines, body).velocity - *next.stop) - next.crossed);
      thrown_.push_back(next);
    });
  }
  std::ranges::copy_if(passed_, std::back_inserter(near_thrown_),
                       [&](const Pair& pair) { return meeting_of(model, outlines, pair).is_thrown(); });
  sort_unique(near_thrown_);
  pairs_.insert(pairs_.end(), near_thrown_.begin(), near_thrown_.end());
  sort_unique(pairs_);
  known_.forget(), looked_around_ = {};
  for (const Pair& pair : near_thrown_) {
    const std::span<const std::uint32_t> former = known_.of(model, pair);
    if (std::ranges::any_of(former,
                            [&](std::uint32_t slot) { return model.contacts[slot].found_in == model.step + 1; }))
      continue;
    const Meeting meeting = meeting_of(model, outlines, pair);
    if (!(meeting.first->is_hasty || (meeting.second && meeting.second->is_hasty))) {
      (void)touch(model, outlines, pair, meeting, former);
    } else {
      if (meeting.second) ingredient::Contacts::tie(model, pair.first, pair.second);
      hasty_.push_back(model.bodies[pair.first].articulate);
    }
  }
}

// The same for the pairs of an island in a part of the step. Without it plates of 1 cm that were struck went through each other.
void ContactFinder::throw_in_part(const model::Model& model, contact::Outlines& outlines) {
  thrown_.clear();
  for (const auto& [pair, meeting, apart] : listed_)
    if (apart < h_ && h_ * meeting.speed() > of_size * meeting.size)
      note_impact(model, meeting, pair.second, meeting.speed() + fall_, true);
  for (const Thrown& thrown : thrown_) {
    Mover& mover = mover_at(model, outlines, thrown.body);
    if (thrown.reach > of_size * mover.reach) mover.thrown = std::max(mover.thrown, thrown.reach);
  }
  const auto box_of = [&](Mover& mover) -> const geometry::Bounds& {
    if (!mover.box) mover.box = contact::bounds(placed(outlines, mover));
    return *mover.box;
  };
  for (bool goes_on = !thrown_.empty(); std::exchange(goes_on, false);)
    for (const auto& [pair, meeting, apart] : listed_) {
      if (!meeting.second || !meeting.is_thrown()) continue;
      const double gap = geometry::distance(box_of(*meeting.first), box_of(*meeting.second));
      for (const auto& [from, to] :
           {std::pair(meeting.first, meeting.second), std::pair(meeting.second, meeting.first)})
        if (const double left = from->thrown - gap; left > to->thrown && model::is_free(model.bodies[to->body].kind))
          to->thrown = left, goes_on = true;
    }
}

// Only pairs of one island: all that is in it has taken the same part of the step.
void ContactFinder::list_pairs_of(const model::Model& model, contact::Outlines& outlines,
                                  std::span<const std::uint32_t> bodies) {
  listed_.clear();
  is_here_.resize(std::max<std::size_t>(is_here_.size(), model.bodies.slot_count()), 0);
  for (const std::uint32_t body : bodies) is_here_[body] = 1;
  for (const std::uint32_t body : bodies)
    for (auto at = std::lower_bound(pairs_.begin(), pairs_.end(), Pair{body, 0});
         at != pairs_.end() && at->first == body; ++at)
      if ((model.bodies[at->second].kind == BodyKind::static_ || is_here_[at->second]) && !is_sensor(model, *at))
        listed_.push_back({*at, meeting_of(model, outlines, *at)});
  for (const std::uint32_t body : bodies) is_here_[body] = 0;
}

void ContactFinder::list_contacts_of(const model::Model& model, std::span<const std::uint32_t> bodies) {
  contacts_.clear();
  if (model.contacts.size() == 0) return;
  for (const std::uint32_t body : bodies)
    model.contacts.for_each_of(body, [&](std::uint32_t slot) { contacts_.push_back(slot); });
  sort_unique(contacts_);
}

// Bodies that were asleep when the step began have contacts, but no pairs. Without them a tower that a ball wakes fell into itself for
// a step.
void ContactFinder::add_pairs_of_woken(const model::Model& model) {
  const std::size_t known = pairs_.size();
  for (const std::uint32_t slot : contacts_) {
    const ingredient::Contact& c = model.contacts[slot];
    const auto [body, other] = ingredient::pair_of(model, c);
    const Pair pair{body, other};
    if (!c.is_off && !std::binary_search(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(known), pair))
      pairs_.push_back(pair);
  }
  if (pairs_.size() > known) sort_unique(pairs_);
}

std::optional<double> ContactFinder::find_part(model::Model& model, contact::Outlines& outlines,
                                               std::span<const std::uint32_t> bodies, double left, const Part& which) {
  const std::size_t most_parts = std::max<std::size_t>(2, most_in_parts / bodies.size());
  shortest_ = step_ / static_cast<double>(std::min<std::size_t>(most_parts, Heap::most_sub_steps));
  begin_look(model, left, false);
  list_contacts_of(model, bodies);
  add_pairs_of_woken(model);
  list_pairs_of(model, outlines, bodies);
  double part = left;
  if (which.may_cut)
    for (auto& [pair, meeting, apart] : listed_) {
      const Ahead ahead = look_ahead(model, outlines, pair, meeting);
      apart = ahead.apart, part = std::min(part, ahead.part);
    }
  if (left - part < least * step_) part = left;  // the rest is round-off
  set_length(model, part);
  if (!which.of_sweeps) throw_in_part(model, outlines);
  known_.forget();
  ingredient::Contacts::begin_part(model, contacts_, which.is_first);
  for (const auto& [pair, meeting, apart] : listed_) {
    if (!(apart < part || meeting.is_thrown())) continue;
    const std::span<const std::uint32_t> former = known_.of(model, pair);
    const bool is_calm = step_ * meeting.speed() < still * meeting.size;
    if (!which.of_sweeps || !(is_calm || which.is_first) || !ingredient::Contacts::keep(model, former))
      (void)touch(model, outlines, pair, meeting, former);
    // They are found within the step, not where it begins.
    model.stands.erase(pair.first);
    if (meeting.second) model.stands.erase(pair.second);
  }
  ingredient::Contacts::end_part(model, contacts_);
  return part < left ? std::optional(part) : std::nullopt;
}

}  // namespace iota::step
