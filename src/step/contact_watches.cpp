// SPDX-License-Identifier: Apache-2.0
#include "step/contact_watches.h"

#include "ingredient/ignored_contacts.h"
#include "ingredient/model.h"
#include "math/checks.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>

namespace iota::step {

using ingredient::Contact;

namespace {

constexpr double end_share = 1e-4;  ///< of the smaller body: a gap that ends a touch

bool is_awake(const model::Body& body) { return body.kind == BodyKind::dynamic || body.kind == BodyKind::scripted; }

std::pair<BodyId, BodyId> in_order(BodyId a, BodyId b) { return a < b ? std::pair(a, b) : std::pair(b, a); }

/// The gap of two bodies that ends their touch, m.
double end_gap(const model::Model& model, const contact::Outlines& outlines, std::uint32_t a, std::uint32_t b) {
  double size = std::numeric_limits<double>::infinity();
  for (const std::uint32_t body : {a, b})
    if (model.bodies[body].kind != BodyKind::static_ && outlines.reach(body) > 0)
      size = std::min(size, outlines.reach(body));
  return end_share * size;
}

bool is_of(const model::Model& model, BodyId body, const std::vector<ContactParty>& side) {
  return side.empty() || std::any_of(side.begin(), side.end(), [&](ContactParty party) {
           if (party.body) party.body = model.survivor_of(party.body).value_or(party.body);
           return ingredient::belongs(model, body.slot, party);
         });
}

}  // namespace

std::uint32_t ContactWatches::add(const model::Model& model, contact::Outlines& outlines, const ContactFilter& filter) {
  require_not_negative("min_impulse", filter.min_impulse);
  require_not_negative("min_speed", filter.min_speed);
  require_not_negative("cooldown", filter.cooldown);
  if (watches_.empty()) touching_.clear(), look_anew(model, outlines);
  watches_.push_back({++last_watch_, filter, {}, {}});
  return last_watch_;
}

void ContactWatches::remove(std::uint32_t watch) {
  std::erase_if(watches_, [&](const Watch& each) { return each.number == watch; });
}

void ContactWatches::begin_step(const model::Model& model, contact::Outlines& outlines) {
  if (watches_.empty() || model.restores == restores_) return;
  for (Watch& watch : watches_) watch.times.clear();
  look_anew(model, outlines);
}

// Touches that there were before keep their numbers.
void ContactWatches::look_anew(const model::Model& model, contact::Outlines& outlines) {
  restores_ = model.restores, knows_sensed_ = model.step == 0;
  outlines.describe();
  list_near(model, outlines, true);
  still_.clear();
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (i > 0 && near_[i].pair == near_[i - 1].pair) continue;
    const auto known = std::lower_bound(touching_.begin(), touching_.end(), near_[i].pair,
                                        [](const Touching& t, const Pair& pair) { return t.pair < pair; });
    still_.push_back(known != touching_.end() && known->pair == near_[i].pair ? *known
                                                                              : begin(model, i, i + 1, 0).touching);
  }
  touching_.swap(still_);
}

void ContactWatches::list_near(const model::Model& model, const contact::Outlines& outlines, bool also_asleep,
                               const std::vector<Sensed>& sensed) {
  near_.clear();
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    if (!also_asleep && !is_awake(model.bodies[c.p]) && !is_awake(model.bodies[c.q])) return;
    const bool has_touched = c.has_touched();
    if (c.is_off && !has_touched) return;
    if (has_touched || ingredient::Contacts::gap(model, c) <= end_gap(model, outlines, c.p, c.q))
      near_.push_back({in_order(model.bodies.id(c.p), model.bodies.id(c.q)), slot, nullptr, has_touched});
  });
  for (const Sensed& each : sensed)
    if (each.gap <= end_gap(model, outlines, each.body, each.other))
      near_.push_back(
          {in_order(model.bodies.id(each.body), model.bodies.id(each.other)), model::none, &each, each.gap <= 0});
  std::sort(near_.begin(), near_.end(),
            [](const Near& a, const Near& b) { return std::tie(a.pair, a.slot) < std::tie(b.pair, b.slot); });
}

// A body that another one has absorbed touches as that one. A touch that two bodies of one pair had ends for one of them.
void ContactWatches::follow_edits(const model::Model& model) {
  const auto is_alive = [&](const Touching& t) {
    return model.bodies.contains(t.pair.first) && model.bodies.contains(t.pair.second);
  };
  if (std::all_of(touching_.begin(), touching_.end(), is_alive)) return;
  for (Touching& t : touching_) {
    if (is_alive(t)) continue;
    const auto a = model.survivor_of(t.pair.first), b = model.survivor_of(t.pair.second);
    const Pair pair = a && b ? in_order(*a, *b) : Pair{};
    const bool is_known =
        std::any_of(touching_.begin(), touching_.end(), [&](const Touching& other) { return other.pair == pair; });
    if (!a || !b || *a == *b || is_known) {
      changes_.push_back({t, false});
      t.number = 0;
    } else {
      t.body = model.survivor_of(t.body).value(), t.other = model.survivor_of(t.other).value(), t.pair = pair;
    }
  }
  std::erase_if(touching_, [](const Touching& t) { return t.number == 0; });
  std::sort(touching_.begin(), touching_.end(), [](const Touching& a, const Touching& b) { return a.pair < b.pair; });
}

// The place is that of the hardest contact of the pair.
ContactWatches::Change ContactWatches::begin(const model::Model& model, std::size_t first, std::size_t last, double h) {
  if (const Sensed* const sensed = near_[first].sensed) {
    Change change{
        {near_[first].pair, ++last_touch_, model.bodies.id(sensed->body), model.bodies.id(sensed->other), {}, {}},
        true,
        0,
        sensed->speed};
    place(model, near_[first], change.touching);
    return change;
  }
  const ingredient::ContactPair pair = ingredient::pair_of(model, model.contacts[near_[first].slot]);
  Change change{{near_[first].pair, ++last_touch_, model.bodies.id(pair.body), model.bodies.id(pair.other), {}, {}},
                true};
  Vec3 sum;
  double hardest = -1;
  for (std::size_t i = first; i < last; ++i) {
    const Contact& c = model.contacts[near_[i].slot];
    const double sign = c.p == pair.body ? 1 : -1;
    // Other schemes than those of single steps tell no impulse.
    const Vec3 impulse = c.impulse != Vec3{} ? c.impulse : h * c.force();
    sum += sign * impulse;
    change.speed = std::max(change.speed, c.approach);
    if (!(norm(impulse) > hardest)) continue;
    hardest = norm(impulse);
    change.touching.position = ingredient::Contacts::place(model, c), change.touching.normal = sign * c.normal;
  }
  change.impulse = norm(sum);
  return change;
}

void ContactWatches::place(const model::Model& model, const Near& near, Touching& t) {
  if (near.sensed) {
    t.position = near.sensed->position;
    t.normal = (model.bodies.id(near.sensed->body) == t.body ? 1.0 : -1.0) * near.sensed->normal;
    return;
  }
  const Contact& c = model.contacts[near.slot];
  t.position = ingredient::Contacts::place(model, c);
  t.normal = (model.bodies.id(c.p) == t.body ? 1.0 : -1.0) * c.normal;
}

void ContactWatches::compare(const model::Model& model, double h) {
  still_.clear();
  auto known = touching_.begin();
  const auto pass_over = [&](const Touching& t) {
    const model::Body &a = model.bodies[t.pair.first.slot], &b = model.bodies[t.pair.second.slot];
    const bool sleeps = !is_awake(a) && !is_awake(b) && (a.kind == BodyKind::resting || b.kind == BodyKind::resting);
    if (sleeps)
      still_.push_back(t);
    else
      changes_.push_back({t, false});
  };
  for (std::size_t first = 0, last; first < near_.size(); first = last) {
    const Pair pair = near_[first].pair;
    bool has_touched = false;
    for (last = first; last < near_.size() && near_[last].pair == pair; ++last)
      has_touched = has_touched || near_[last].has_touched;
    while (known != touching_.end() && known->pair < pair) pass_over(*known++);
    if (known != touching_.end() && known->pair == pair) {
      place(model, near_[first], still_.emplace_back(*known++));
    } else if (near_[first].sensed && !near_[first].sensed->is_passed && !knows_sensed_) {
      still_.push_back(begin(model, first, last, h).touching);
    } else if (has_touched) {
      still_.push_back(changes_.emplace_back(begin(model, first, last, h)).touching);
    }
  }
  while (known != touching_.end()) pass_over(*known++);
  touching_.swap(still_);
  knows_sensed_ = true;
}

void ContactWatches::end_step(const model::Model& model, contact::Outlines& outlines, const std::vector<Sensed>& sensed,
                              StepReport& report) {
  if (watches_.empty()) return;
  changes_.clear();
  follow_edits(model);
  list_near(model, outlines, false, sensed);
  compare(model, report.dt);
  std::sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
    return std::tie(a.touching.pair, a.began, a.touching.number) <
           std::tie(b.touching.pair, b.began, b.touching.number);
  });
  for (const Change& change : changes_)
    for (Watch& watch : watches_) tell(model, watch, change, report);
}

bool ContactWatches::passes(const model::Model& model, Watch& watch, const Change& change) {
  const ContactFilter& filter = watch.filter;
  if (!(change.impulse >= filter.min_impulse && change.speed >= filter.min_speed)) return false;
  if (!(filter.cooldown > 0)) return true;
  std::erase_if(watch.times,
                [&](const auto& each) { return !(model.time < each.second + filter.cooldown * (1 - 1e-9)); });
  return watch.times.emplace(change.touching.pair, model.time).second;
}

void ContactWatches::tell(const model::Model& model, Watch& watch, const Change& change, StepReport& report) {
  const Touching& t = change.touching;
  bool is_turned = false;
  if (change.began) {
    const ContactFilter& filter = watch.filter;
    is_turned = !(is_of(model, t.body, filter.a) && is_of(model, t.other, filter.b));
    if (is_turned && !(is_of(model, t.other, filter.a) && is_of(model, t.body, filter.b))) return;
    if (!passes(model, watch, change)) return;
    watch.told.push_back({t.number, is_turned});
  } else {
    const auto told = std::lower_bound(watch.told.begin(), watch.told.end(), t.number,
                                       [](const Told& each, std::uint64_t number) { return each.number < number; });
    if (told == watch.told.end() || told->number != t.number) return;
    is_turned = told->is_turned;
    watch.told.erase(told);
  }
  report.contacts.push_back({.watch = watch.number,
                             .began = change.began,
                             .body = is_turned ? t.other : t.body,
                             .other = is_turned ? t.body : t.other,
                             .position = t.position,
                             .normal = (is_turned ? -1.0 : 1.0) * t.normal,
                             .impulse = change.impulse,
                             .speed = change.speed});
}

}  // namespace iota::step
