// SPDX-License-Identifier: Apache-2.0
#include "island/islands.h"

#include "base/sort_unique.h"
#include "ingredient/attachments.h"

#include <iota/reports.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace iota::island {

using model::Model;
using model::none;

void Islands::forget() {
  entries_.clear(), home_of_leader_.clear(), suspected_.clear(), spare_ = {};
  in_order_.clear(), leaders_.clear(), changed_leaders_.clear();
  stills_.clear(), changed_stills_.clear(), awake_indices_.clear();
  free_bodies_.forget();
  ++epoch_;
  knows_all_ = false, order_is_old_ = awake_is_old_ = true;
}

void Islands::renew(Model& model) {
  renew_ = true;
  auto& [rings, ends, work] = model.eliminations;
  rings.clear(), ends.clear(), work.clear();
  for (const auto& home : home_of_leader_) {
    if (!home || !home->is_built) continue;
    // An order of few points is found again: it depends on the structure alone, unlike that of a dissection by places.
    if (home->is_small() || !home->island.keeps_order()) continue;
    home->island.append_order(rings);
    ends.push_back(static_cast<std::uint32_t>(rings.size())), work.push_back(home->island.order_work());
  }
}

void Islands::wait(std::uint32_t articulate) {
  Entry& entry = entries_[articulate];
  if (entry.is_waiting) return;
  entry.is_waiting = true;
  waiting_.push_back(articulate);
}

// Its articulates will get another one.
void Islands::drop(Home& home) {
  forget_suspects(home);
  std::erase(changed_, &home);
  for (const std::uint32_t a : home.articulates) {
    entries_[a].home = nullptr;
    wait(a);
  }
  retire(home.leader);
}

Islands::Home& Islands::new_home(std::uint32_t leader, std::size_t points) {
  std::unique_ptr<Home>& home = home_of_leader_[leader];
  home = take_spare(points);
  if (!home) home = std::make_unique<Home>();
  home->leader = leader;
  changed_leaders_.push_back(leader);
  return *home;
}

// The smallest one that has room, or else the largest one, which gets it: taken at random, each would grow to the size
// of the largest island.
std::unique_ptr<Islands::Home> Islands::take_spare(std::size_t points) {
  const auto first = std::min<std::size_t>(std::bit_width(points), spare_.size() - 1);
  const auto take = [](auto& list) {
    std::unique_ptr<Home> home = std::move(list.back());
    list.pop_back();
    return home;
  };
  for (std::size_t i = first; i < spare_.size(); ++i)
    if (!spare_[i].empty()) return take(spare_[i]);
  for (std::size_t i = first; i-- > 0;)
    if (!spare_[i].empty()) return take(spare_[i]);
  return nullptr;
}

void Islands::retire(std::uint32_t leader) {
  constexpr std::size_t most_spare = 1 << 15;  // points of one size
  std::unique_ptr<Home> home = std::move(home_of_leader_[leader]);
  changed_leaders_.push_back(leader);
  home->clear();
  const auto bits = static_cast<std::size_t>(std::bit_width(home->island.room()));
  if (bits >= spare_.size() || spare_[bits].size() << bits >= most_spare) return;
  spare_[bits].push_back(std::move(home));
}

void Islands::set_leader(Home& home) {
  auto holder = std::move(home_of_leader_[home.leader]);
  changed_leaders_.push_back(home.leader);
  home.leader = home.articulates.front();
  changed_leaders_.push_back(home.leader);
  home_of_leader_[home.leader] = std::move(holder);
}

void Islands::set_members(Home& home, std::span<const std::uint32_t> articulates) {
  home.articulates.assign(articulates.begin(), articulates.end());
  for (const std::uint32_t a : articulates) {
    free_bodies_.set(a, false);
    entries_[a].home = &home, entries_[a].is_waiting = false;
  }
}

// Prepares data and table rows of an island before the parallel build.
void Islands::make_ready(Model& model, std::uint32_t body) {
  model.prefer_unknowns(body);
  ingredient::prepare(model, body);
}

bool Islands::update(Model& model, const Parallel& parallel, MovedRings& moved) {
  model.take_marked(marked_);
  if (std::exchange(renew_, false)) forget();
  kept_orders_.read(model);
  if (!model.eliminations.ends.empty()) model.eliminations = {};
  if (!knows_all_) {
    marked_.articulates.clear();
    model.articulates.for_each([&](std::uint32_t a, const model::Articulate&) { marked_.articulates.push_back(a); });
    marked_.only_locally.assign(marked_.articulates.size(), 0);
    knows_all_ = true;
  }
  waiting_.clear(), changed_.clear(), fresh_.clear(), fresh_loose_.clear();
  const bool any_is_due =
      std::any_of(suspected_.begin(), suspected_.end(), [&](const Home* home) { return is_due(*home, model); });
  if (marked_.articulates.empty() && marked_.local.pulled.empty() && waiting_.empty() && !any_is_due)
    return kept_orders_.clear(), false;
  ++epoch_;
  order_is_old_ = awake_is_old_ = true;
  entries_.resize(model.articulates.slot_count()), home_of_leader_.resize(entries_.size());
  node_of_ring_.resize(model.rings.slot_count(), none), is_own_.resize(model.bodies.slot_count(), 0);

  drop_marked(model);
  find_changed(model);
  take_parts_out(model);
  find_groups(model);
  const bool any = group_count_ > 0;
  form_groups(model, moved);
  renew_pulls(model);
  marked_.local.bodies.clear(), changed_.clear(), joins_.clear();
  if (!waiting_.empty()) find_groups(model), form_groups(model, moved);  // of homes that could not follow
  build_fresh(model, parallel, moved);
  note_suspects(model);
  kept_orders_.clear();
  return any || !fresh_.empty() || !fresh_loose_.empty();
}

// 1. Homes with other than local changes are dropped.
void Islands::drop_marked(const Model& model) {
  for (std::size_t i = 0; i < marked_.articulates.size(); ++i) {
    if (marked_.only_locally[i]) continue;
    const std::uint32_t a = marked_.articulates[i];
    if (Home* const home = entries_[a].home)
      drop(*home);
    else
      wait(a), entries_[a].has_other_changes = true;
  }
  for (const std::uint32_t body : marked_.local.pulled) {  // a grip may be all that holds a body
    if (!model.bodies.is_alive(body)) continue;
    const std::uint32_t a = model.bodies[body].articulate;
    Home* const home = entries_[a].home;
    if (model.articulates[a].count == 1 && (!home || home->articulates.size() == 1)) home ? drop(*home) : wait(a);
  }
}

// 2. Homes that must follow local changes, with their present articulates. Small ones are dropped.
void Islands::find_changed(const Model& model) {
  for (const std::uint32_t a : marked_.articulates)
    if (Home* const home = entries_[a].home) home->is_small() ? drop(*home) : note_changed(*home);
  sort_unique(marked_.local.reborn);
  homes_.assign(changed_.begin(), changed_.end());
  for (Home* const home : homes_) find_members(model, *home);
  for (const std::uint32_t a : marked_.articulates) {
    entries_[a].has_other_changes = false;
    if (!entries_[a].home) wait(a);  // made by a cut, of a home that was dropped
  }
}

void Islands::note_changed(Home& home) {
  if (std::exchange(home.is_changed, true)) return;
  changed_.push_back(&home);
}

// Articulates of its bodies. Some are new, made by cuts; hinges have put bodies into those of other homes.
void Islands::find_members(const Model& model, Home& home) {
  const auto bodies = home.island.bodies();
  const auto& reborn = marked_.local.reborn;
  const auto is_its_own = [&](std::uint32_t body) {
    return model.bodies.is_alive(body) && !std::binary_search(reborn.begin(), reborn.end(), body) &&
           !entries_[model.bodies[body].articulate].has_other_changes;
  };
  if (!std::all_of(bodies.begin(), bodies.end(), is_its_own)) return drop(home);
  members_.assign(home.articulates.begin(), home.articulates.end());
  for (const std::uint32_t a : members_) entries_[a].home = nullptr;
  home.articulates.clear();
  std::uint32_t elsewhere = none;  // the latest
  for (const std::uint32_t body : bodies) {
    const std::uint32_t a = model.bodies[body].articulate;
    Entry& entry = entries_[a];
    if (entry.home == &home || a == elsewhere) continue;
    if (entry.home || entry.is_waiting)
      joins_.push_back({&home, elsewhere = a});
    else
      entry.home = &home, home.articulates.push_back(a);
  }
  for (const std::uint32_t a : members_)  // with inactive bodies only: the island does not list them
    if (!entries_[a].home && model.articulates.is_alive(a)) wait(a);
  if (home.articulates.empty()) return;
  std::sort(home.articulates.begin(), home.articulates.end());
  set_leader(home);
}

bool Islands::is_due(const Home& home, const Model& model) {
  constexpr std::uint64_t patience = 120;  // steps
  return home.suspected_at + patience <= model.step;
}

// 3. Parts that were cut off wait for homes of their own: small ones at once, so that of loose bodies the islands are
// those of the present ties alone. A large part costs as much as an assembly, and a cut is often closed soon: it leaves
// some steps after the cut, also if other cuts go on. Until then the solver needs no more time for it than it would by
// itself, but what happens in one part may halve the step of both.
void Islands::take_parts_out(const Model& model) {
  constexpr std::size_t small = 16;  // bodies
  for (const std::uint32_t a : marked_.articulates)
    if (Home* const home = entries_[a].home) home->marked.push_back(a);
  for (Home* const home : changed_) {
    take_parts_out(model, *home, home->marked, small);
    home->marked.clear();
  }
  homes_.assign(suspected_.begin(), suspected_.end());
  for (Home* const home : homes_) {
    if (!is_due(*home, model)) continue;
    members_.assign(home->suspects.begin(), home->suspects.end());
    forget_suspects(*home);
    std::erase_if(members_, [&](std::uint32_t a) { return entries_[a].home != home; });
    take_parts_out(model, *home, members_, none);
  }
}

void Islands::take_parts_out(const Model& model, Home& home, std::span<const std::uint32_t> suspects,
                             std::size_t most_bodies) {
  const auto is_member = [&](std::uint32_t a) { return entries_[a].home == &home; };
  const std::size_t before = home.leaving.size();
  cut_search_.find(model, suspects, most_bodies, is_member, home.leaving);
  if (home.leaving.size() == before) return;
  for (const std::uint32_t a : home.leaving) entries_[a].home = nullptr, wait(a);
  std::erase_if(home.articulates, [&](std::uint32_t a) { return !is_member(a); });
  set_leader(home);
  note_changed(home);
}

std::uint32_t Islands::unit_of(Home& home) {
  if (home.unit == none) {
    home.unit = static_cast<std::uint32_t>(units_.size());
    units_.push_back({&home, none, home.unit});
  }
  return home.unit;
}

// The unit of the home of an articulate, or of the articulate, which waits for one from now on.
std::uint32_t Islands::unit_of(std::uint32_t articulate) {
  Entry& entry = entries_[articulate];
  if (entry.home && entry.home->is_small()) drop(*entry.home);
  if (entry.home) return unit_of(*entry.home);
  wait(articulate);
  if (entry.unit == none) {
    entry.unit = static_cast<std::uint32_t>(units_.size());
    units_.push_back({nullptr, articulate, entry.unit});
  }
  return entry.unit;
}

std::uint32_t Islands::root_of(std::uint32_t unit) {
  while (units_[unit].parent != unit) unit = units_[unit].parent = units_[units_[unit].parent].parent;
  return unit;
}

// 4. What bonds and constraints tie together is solved together: a search from all that waits, and from all bodies of
// homes that have changed.
void Islands::find_groups(const Model& model) {
  units_.clear();
  const auto search = [&](std::uint32_t unit, std::uint32_t body) {
    const Home* const own = units_[unit].home;
    const auto reach = [&](std::uint32_t far) {
      const std::uint32_t a = model.bodies[far].articulate;
      if (a == units_[unit].articulate || (own && entries_[a].home == own)) return;
      const std::uint32_t with = unit_of(a);
      units_[root_of(unit)].parent = root_of(with);
    };
    model.for_each_particle_of(body, [&](std::uint32_t p) { model.visit_tied(p, Model::Ties::all, reach); });
  };
  for (Home* const home : changed_) (void)unit_of(*home);
  for (const auto& [home, articulate] : joins_)
    if (entries_[articulate].home != home) {
      const std::uint32_t with = unit_of(articulate);
      units_[root_of(unit_of(*home))].parent = root_of(with);
    }
  sort_unique(marked_.local.bodies);
  for (const std::uint32_t body : marked_.local.bodies)
    if (model.bodies.is_alive(body))
      if (Home* const home = entries_[model.bodies[body].articulate].home) search(unit_of(*home), body);
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const std::uint32_t a = waiting_[i];
    Entry& entry = entries_[a];
    const bool is_alive = model.articulates.is_alive(a), is_free = is_alive && FreeBodies::is_free(model, a);
    free_bodies_.set(a, is_free);
    if (is_free && !FreeBodies::is_particle(model, a)) fresh_loose_.push_back(a);
    if (!is_alive || is_free) {
      entry.is_waiting = false;
      continue;
    }
    const std::uint32_t unit = unit_of(a);
    model.for_each_body_of(a, [&](std::uint32_t body) { search(unit, body); });
  }
  waiting_.clear();
  collect_groups(model);
}

Islands::Group& Islands::group_of(std::uint32_t unit) {
  std::uint32_t& group = group_of_[root_of(unit)];
  if (group == none) {
    group = static_cast<std::uint32_t>(group_count_++);
    if (groups_.size() < group_count_) groups_.emplace_back();
    groups_[group].clear();
  }
  return groups_[group];
}

// The result does not depend on the order of discovery.
void Islands::collect_groups(const Model& model) {
  group_of_.assign(units_.size(), none);
  group_count_ = 0;
  for (std::uint32_t unit = 0; unit < units_.size(); ++unit)
    if (Home* const home = units_[unit].home)
      group_of(unit).homes.push_back(home);
    else
      group_of(unit).waiting.push_back(units_[unit].articulate);
  for (const std::uint32_t body : marked_.local.bodies) {
    if (!model.bodies.is_alive(body)) continue;
    const Entry& entry = entries_[model.bodies[body].articulate];  // a home's body may be in an articulate that waits
    const std::uint32_t unit = entry.home ? entry.home->unit : entry.unit;
    if (unit != none) group_of(unit).bodies.push_back(body);
  }
  for (const Unit& unit : units_) (unit.home ? unit.home->unit : entries_[unit.articulate].unit) = none;
  by_lowest_.clear();
  for (std::uint32_t g = 0; g < group_count_; ++g) {
    Group& group = groups_[g];
    std::sort(group.homes.begin(), group.homes.end(),
              [](const Home* x, const Home* y) { return x->leader < y->leader; });
    std::sort(group.waiting.begin(), group.waiting.end());
    group.lowest = std::min(group.homes.empty() ? none : group.homes.front()->leader,
                            group.waiting.empty() ? none : group.waiting.front());
    by_lowest_.push_back(g);
  }
  std::sort(by_lowest_.begin(), by_lowest_.end(),
            [&](std::uint32_t x, std::uint32_t y) { return groups_[x].lowest < groups_[y].lowest; });
}

// 5. In each group the largest home follows, or all become a new one.
void Islands::form_groups(Model& model, MovedRings& moved) {
  for (const std::uint32_t g : by_lowest_) {
    const Group& group = groups_[g];
    if (group.homes.empty()) {
      std::size_t points = 0;
      for (const std::uint32_t a : group.waiting)
        model.for_each_body_of(a, [&](std::uint32_t body) { points += model.bodies[body].count; });
      Home& home = new_home(group.waiting.front(), points);
      set_members(home, group.waiting);
      fresh_.push_back(&home);
    } else if (!follow(model, group, moved)) {
      for (Home* const home : group.homes) drop(*home);
      for (const std::uint32_t a : group.waiting) entries_[a].is_waiting = false, wait(a);
    }
  }
}

// The largest home takes the others over, at the cost of these.
bool Islands::follow(Model& model, const Group& group, MovedRings& moved) {
  Home& host = **std::max_element(group.homes.begin(), group.homes.end(),
                                  [](const Home* a, const Home* b) { return a->island.size() < b->island.size(); });
  std::vector<std::uint32_t>& members = members_;
  members = group.waiting;
  for (const Home* const home : group.homes)
    members.insert(members.end(), home->articulates.begin(), home->articulates.end());
  std::sort(members.begin(), members.end());
  const auto is_member = [&](std::uint32_t a) { return std::binary_search(members.begin(), members.end(), a); };

  Island::Change& change = change_;
  change.clear();
  std::size_t joined_points = 0;
  const auto join = [&](std::uint32_t body) {
    if (is_own_[body] || model.bodies[body].kind == BodyKind::inactive || model.bodies[body].count == 0) return;
    change.joined.push_back(body);
    joined_points += model.bodies[body].count;
  };
  const bool keeps_all = group.homes.size() == 1 && group.waiting.empty() && host.leaving.empty();
  if (!keeps_all) {
    for (const std::uint32_t body : host.island.bodies()) is_own_[body] = 1;
    for (const std::uint32_t a : host.leaving)
      if (!is_member(a))
        model.for_each_body_of(a, [&](std::uint32_t body) {
          if (is_own_[body]) change.left.push_back(body);
        });
    for (const Home* const home : group.homes) {
      if (home == &host) continue;
      home->island.append_order(change.joined_rings);
      for (const std::uint32_t body : home->island.bodies())
        if (is_member(model.bodies[body].articulate)) join(body);
    }
    for (const std::uint32_t a : group.waiting) model.for_each_body_of(a, join);
    for (const std::uint32_t body : host.island.bodies()) is_own_[body] = 0;
    sort_unique(change.joined), sort_unique(change.left);
  }
  std::size_t expected = 0;
  for (const std::uint32_t a : members) expected += model.articulates[a].count;
  if (expected != host.island.body_count() - change.left.size() + change.joined.size()) return false;
  if (joined_points > host.island.size()) return false;

  change.local.bodies = group.bodies;
  change.local.bodies.insert(change.local.bodies.end(), change.joined.begin(), change.joined.end());
  sort_unique(change.local.bodies);
  change.local.rings = marked_.local.rings, change.local.pulled = marked_.local.pulled;
  for (const std::uint32_t body : change.local.bodies) make_ready(model, body);
  if (!host.island.follow(model, members, change, node_of_ring_, moved)) return false;

  host.leaving.clear(), host.is_changed = false, host.has_followed = true;
  for (Home* const home : group.homes) {
    if (home == &host) continue;
    for (const std::uint32_t a : home->suspects) add_suspect(host, a, home->suspected_at);
    std::erase(suspected_, home);
    retire(home->leader);
  }
  set_members(host, members);
  set_leader(host);
  return true;
}

void Islands::add_suspect(Home& home, std::uint32_t articulate, std::uint64_t step) {
  if (home.suspects.empty()) suspected_.push_back(&home), home.suspected_at = step;
  home.suspected_at = std::min(home.suspected_at, step);
  home.suspects.push_back(articulate);
}

void Islands::forget_suspects(Home& home) {
  for (const std::uint32_t a : home.suspects) entries_[a].is_suspect = false;
  if (!home.suspects.empty()) std::erase(suspected_, &home);
  home.suspects.clear();
}

// A cut touches articulates on both of its sides.
void Islands::note_suspects(const Model& model) {
  for (const std::uint32_t a : marked_.articulates) {
    Home* const home = entries_[a].home;
    if (!home || !home->has_followed || home->articulates.size() == 1) continue;
    if (!std::exchange(entries_[a].is_suspect, true)) add_suspect(*home, a, model.step);
  }
}

void Islands::renew_pulls(const Model& model) {
  for (const std::uint32_t body : marked_.local.pulled) {
    if (!model.bodies.is_alive(body)) continue;
    Home* const home = entries_[model.bodies[body].articulate].home;
    if (!home || !home->is_built) continue;  // it will be built, with its pulls
    if (!home->island.renew_pulls(model, node_of_ring_)) drop(*home);
  }
}

// 6. New ones are built separately, in parallel if there are many.
void Islands::build_fresh(Model& model, const Parallel& parallel, MovedRings& moved) {
  for (const Home* const home : fresh_)
    for (const std::uint32_t a : home->articulates)
      model.for_each_body_of(a, [&](std::uint32_t body) { make_ready(model, body); });
  sort_unique(fresh_loose_);
  for (const std::uint32_t a : fresh_loose_) make_ready(model, model.articulates[a].first);
  const std::size_t count = fresh_.size() + fresh_loose_.size();
  if (moved_by_.size() < count) moved_by_.resize(count);
  parallel.for_each(count, 8, [&](std::size_t i) {
    moved_by_[i].before.clear(), moved_by_[i].is_asked_for = moved.is_asked_for;
    const auto carry_along = [&](Island& island) { island.carry_along(model, moved_by_[i]); };
    if (i >= fresh_.size()) return borrow(model, fresh_loose_[i - fresh_.size()], carry_along);
    fresh_[i]->island.assemble(model, fresh_[i]->articulates, node_of_ring_, kept_orders_);
    fresh_[i]->is_built = true;
    carry_along(fresh_[i]->island);
  });
  for (std::size_t i = 0; i < count; ++i)
    moved.before.insert(moved.before.end(), moved_by_[i].before.begin(), moved_by_[i].before.end());
}

void Islands::validate(const Model& model, model::Audit& audit) const {
  std::vector<const Home*> built(fresh_.begin(), fresh_.end());
  std::sort(built.begin(), built.end());
  audit.require(std::adjacent_find(built.begin(), built.end()) == built.end(),
                "the latest update has built an island twice");
  if (!knows_all_ || model.is_marked()) return;
  model.articulates.for_each([&](std::uint32_t a, const model::Articulate& articulate) {
    const Home* const home = entries_[a].home;
    audit.require((home != nullptr) != free_bodies_.contains(a), "articulate ", a, " is not in one island");
    if (!home) return;
    audit.require(std::binary_search(home->articulates.begin(), home->articulates.end(), a),
                  "the island of articulate ", a, " does not know it");
    for (std::uint32_t b = articulate.first; b != none; b = model.bodies[b].next_in_articulate)
      model.for_each_particle_of(b, [&](std::uint32_t p) {
        model.visit_tied(p, Model::Ties::all, [&](std::uint32_t far) {
          audit.require(entries_[model.bodies[far].articulate].home == home, "bodies ", b, " and ", far,
                        " are tied, and in two islands");
        });
      });
  });
  for (std::uint32_t leader = 0; leader < home_of_leader_.size(); ++leader) {
    const Home* const home = home_of_leader_[leader].get();
    if (!home) continue;
    audit.require(order_is_old_ || (home->index < in_order_.size() && in_order_[home->index] == &home->island &&
                                    leaders_[home->index] == leader),
                  "the island of leader ", leader, " is not where it is in the order");
    audit.require(home->leader == leader && !home->articulates.empty() && home->articulates.front() == leader,
                  "the island of leader ", leader, " has another leader");
    std::size_t bodies = 0;
    for (const std::uint32_t a : home->articulates) {
      audit.require(entries_[a].home == home, "articulate ", a, " is listed by an island that it is not in");
      model.for_each_body_of(a, [&](std::uint32_t b) {
        bodies += model.bodies[b].kind != BodyKind::inactive && model.bodies[b].count > 0;
      });
    }
    audit.require(bodies == home->island.body_count(), "the island of leader ", leader, " has ",
                  home->island.body_count(), " bodies, and its articulates ", bodies);
    for (const std::uint32_t b : home->island.bodies())
      audit.require(model.bodies.is_alive(b) && entries_[model.bodies[b].articulate].home == home, "body ", b,
                    " is in an island without its articulate");
  }
}

void Islands::replace_by_leaders(std::vector<std::uint32_t>& articulates) const {
  if (articulates.empty()) return;  // as in most steps
  for (std::uint32_t& a : articulates)
    a = entries_[a].home ? entries_[a].home->leader : (free_bodies_.contains(a) ? a : none);
  sort_unique(articulates);
  if (!articulates.empty() && articulates.back() == none) articulates.pop_back();  // destroyed ones
}

std::span<Island* const> Islands::all() {
  if (!order_is_old_) return in_order_;
  sort_unique(changed_leaders_);
  if (!replace_in_order()) list_in_order();
  changed_leaders_.clear();
  order_is_old_ = false;
  return in_order_;
}

// An island that is built anew mostly has its leader of before. To look at 4000 others took 0.6 ms.
bool Islands::replace_in_order() {
  const auto is_as_before = [&](std::uint32_t leader) {
    return std::binary_search(leaders_.begin(), leaders_.end(), leader) == (home_of_leader_[leader] != nullptr);
  };
  if (!std::ranges::all_of(changed_leaders_, is_as_before)) return false;
  for (const std::uint32_t leader : changed_leaders_) {
    Home* const home = home_of_leader_[leader].get();
    if (!home) continue;
    const auto at = std::lower_bound(leaders_.begin(), leaders_.end(), leader) - leaders_.begin();
    home->index = static_cast<std::uint32_t>(at);
    in_order_[home->index] = &home->island, stills_[home->index] = {};
    changed_stills_.push_back(home->index);
  }
  return true;
}

void Islands::list_in_order() {
  in_order_.clear(), leaders_.clear(), changed_stills_.clear(), awake_indices_.clear();
  stills_.swap(stills_before_), stills_.clear();
  for (const auto& home : home_of_leader_) {
    if (!home) continue;
    const auto index = static_cast<std::uint32_t>(in_order_.size()), before = std::exchange(home->index, index);
    in_order_.push_back(&home->island), leaders_.push_back(home->leader);
    const Still* const known = before < stills_before_.size() ? &stills_before_[before] : nullptr;
    const bool is_same = known && known->book_epoch != 0 && home->island.has_stayed_still(known->book_epoch);
    stills_.push_back(is_same ? *known : Still{});
    if (!is_same) changed_stills_.push_back(index);
  }
}

// The island of an articulate is not still any more, or is so in another way.
void Islands::note_still(std::uint32_t articulate) {
  awake_is_old_ = true;
  const Home& home = *entries_[articulate].home;
  order_is_old_ ? changed_leaders_.push_back(home.leader) : changed_stills_.push_back(home.index);
}

void Islands::look_whether_still(const Model& model, std::uint32_t index) {
  Island& island = *in_order_[index];
  Still& still = stills_[index];
  still = {.is = island.is_still(), .bodies = static_cast<std::uint32_t>(island.body_count())};
  if (!still.is) return;
  still.is_asleep = island.is_asleep(model);
  island.skip_step();
}

void Islands::refresh_awake(const Model& model) {
  (void)all();
  for (const auto& indices : {&awake_indices_, &changed_stills_})
    for (const std::uint32_t index : *indices) look_whether_still(model, index);
  changed_stills_.clear(), awake_.clear(), awake_indices_.clear();
  still_book_.reset();
  total_size_ = largest_size_ = asleep_ = still_bodies_ = 0;
  for (std::uint32_t index = 0; index < in_order_.size(); ++index) {
    const Still& still = stills_[index];
    if (still.is) {
      still_bodies_ += still.bodies;
      if (still.is_asleep) asleep_ += still.bodies;
      continue;
    }
    Island* const island = in_order_[index];
    awake_.push_back(island), awake_indices_.push_back(index);
    total_size_ += island->size();
    largest_size_ = std::max(largest_size_, island->size());
  }
  awake_is_old_ = false;
  ++awake_version_;
}

std::span<Island* const> Islands::awake(const Model& model) {
  const auto is_still = [](const Island* island) { return island->is_still(); };
  if (order_is_old_ || awake_is_old_ || std::any_of(awake_.begin(), awake_.end(), is_still)) refresh_awake(model);
  return awake_;
}

bool Islands::may_be_still(const Model& model) const {
  const bool is_known = knows_all_ && !renew_ && !order_is_old_ && !awake_is_old_ && !model.is_marked();
  return !is_known || some_became_still_ || still_bodies_ > 0 || free_bodies_.may_rest();
}

void Islands::wake(Model& model, std::span<const std::uint32_t> articulates) {
  for (const std::uint32_t articulate : articulates) {
    Island* const island = of_articulate(articulate);
    if (!island)
      free_bodies_.wake(model, articulate);
    else if (island->is_still())
      note_still(articulate), island->wake();
    else
      island->wake();
  }
}

// A scripted body or a nail has no stride of its own: what its motion disturbs is all that is solved with it. Otherwise it stood
// still while something frozen lay on it, and went all its way in the first step after that, at 29 m/s.
void Islands::end_strides_with(Model& model, std::uint32_t body) {
  if (!ingredient::Strides::any(model)) return;
  const Island* const island = of_articulate(model.bodies[body].articulate);
  if (!island) return ingredient::Strides::disturb(model, body);
  for (const std::uint32_t each : island->bodies())
    if (model.articulates[model.bodies[each].articulate].first == each) ingredient::Strides::disturb(model, each);
}

namespace {

/// visit(body): of the points that an ingredient I stirs.
template <class I, class Visit>
void visit_stirred_by(Model& model, double h, Visit visit) {
  I::visit_stirred(model, h, [&](std::uint32_t ring) {
    model.for_each_in_ring(ring, [&](std::uint32_t p) { visit(model.particles[p].body); });
  });
}

}  // namespace

void Islands::wake_stirred(Model& model, double h) {
  const Island* moved = nullptr;  // of the latest nail
  // Forces wake only what rests, and begin its time before sleep again: to look at each took a twelfth of a step of held bonds.
  const bool may_sleep = model.rest_after > 0 || may_be_still(model);
  ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() {
    constexpr bool moves = std::is_same_v<I, ingredient::Nails>;
    if (!may_sleep && !moves) return;
    visit_stirred_by<I>(model, h, [&](std::uint32_t body) {
      const std::uint32_t articulate = model.bodies[body].articulate;
      // A free body that is awake hears its force itself.
      if (of_articulate(articulate) || free_bodies_.is_resting(model, articulate)) wake(model, {&articulate, 1});
      // Other than forces, which a stride takes as they are at its begin, this is a motion of its own.
      if constexpr (moves)
        if (const Island* const island = of_articulate(articulate); !island || std::exchange(moved, island) != island)
          end_strides_with(model, body);
    });
  });
}

void Islands::flag_stirred_sleepers(Model& model, double h) {
  if (!may_be_still(model)) return;
  ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() {
    visit_stirred_by<I>(model, h, [&](std::uint32_t body) {
      if (model.bodies[body].kind == BodyKind::resting) model.wake(model.bodies[body].articulate);
    });
  });
}

void Islands::put_to_rest(Model& model, std::uint32_t articulate) {
  if (Island* const island = of_articulate(articulate))
    note_still(articulate), island->put_to_rest(model);
  else if (FreeBodies::is_particle(model, articulate))
    free_bodies_.put_to_rest(model, articulate);
  else
    borrow(model, articulate, [&](Island& loose) { loose.put_to_rest(model); }), free_bodies_.note_change();
}

double Islands::share_of(const Island& island) const {
  return static_cast<double>(island.size()) / static_cast<double>(std::max(total_size_, island.size()));
}

double Islands::ahead(const Model& model, const Island& island) const {
  if (ahead_.empty() || island.bodies().empty()) return 0;
  const std::uint32_t articulate = model.bodies[island.bodies().front()].articulate;
  return articulate < ahead_.size() ? ahead_[articulate] : 0;
}

const solver::AdvanceReport& Islands::advance_part(Model& model, Island& island, double part, double h,
                                                   Island::Clock::time_point deadline) {
  ahead_.resize(model.articulates.slot_count(), 0);
  island.for_each_articulate(model, [&](std::uint32_t articulate) { ahead_[articulate] += part; });
  return island.advance_part(model, part, {deadline, share_of(island), part / h});
}

void Islands::advance(Model& model, std::size_t index, double h, Island::Clock::time_point deadline) {
  if (index < awake_.size()) {
    Island& island = *awake_[index];
    const double left = h - ahead(model, island);
    return (void)island.advance(model, left, {deadline, share_of(island), left / h});
  }
  FreeBodies::Loose& loose = free_bodies_.loose()[index - awake_.size()];
  if (loose.goes_on_by_itself(model, h)) return;
  borrow(model, loose.articulate, [&](Island& island) {
    island.read_stride(), (void)island.agree_on_stride(model);
    loose.report = island.advance(model, h, {deadline, share_of(island)});
    loose.rests = island.is_asleep(model), loose.work = island.work(), loose.solved_steps = island.solved_steps();
  });
}

Islands::Work Islands::work_of(const Model& model, std::uint32_t articulate) const {
  if (articulate < entries_.size() && entries_[articulate].home) {
    const Island& island = entries_[articulate].home->island;
    const double share = static_cast<double>(model.articulates[articulate].count) /
                         static_cast<double>(std::max<std::size_t>(1, island.body_count()));
    return {share * island.work(), island.is_still() ? 0 : island.solved_steps()};
  }
  const std::span<const FreeBodies::Loose> loose = free_bodies_.loose();
  const auto at = std::lower_bound(loose.begin(), loose.end(), articulate,
                                   [](const FreeBodies::Loose& l, std::uint32_t a) { return l.articulate < a; });
  if (at == loose.end() || at->articulate != articulate) return {0, 0};
  const bool is_frozen = ingredient::Strides::of(model, at->body) == ingredient::Strides::frozen;
  return {at->work, at->rests || is_frozen ? 0 : at->solved_steps};
}

// Strides of loose bodies are read in each step.
void Islands::plan_strides(Model& model) {
  if (!ingredient::Strides::any(model) && model.changed_strides.empty()) return;
  for (const std::uint32_t body : std::exchange(model.changed_strides, {})) {
    if (!model.bodies.is_alive(body)) continue;
    const std::uint32_t articulate = model.bodies[body].articulate;
    if (Island* const island = of_articulate(articulate)) {
      if (island->is_still()) note_still(articulate);
      island->read_stride();
    }
  }
  for (Island* const island : awake(model)) (void)island->agree_on_stride(model);
  model.changed_strides.clear();  // by agreement
  for (const FreeBodies::Loose& loose : free_bodies_.loose(model)) {
    const std::uint32_t stride = ingredient::Strides::of(model, loose.body);
    if (stride > 1 && stride != ingredient::Strides::frozen)
      model.for_each_particle_of(loose.body,
                                 [&](std::uint32_t p) { (void)model.tracks.make(model.particles[p].ring); });
  }
}

std::vector<IslandReport> Islands::reports(const Model& model) {
  std::vector<std::pair<std::uint32_t, IslandReport>> found;  // by leader
  for (const auto& home : home_of_leader_)
    if (home && home->island.has_stepped())
      found.push_back({home->leader, home->island.report(model, home->island.latest())});
  node_of_ring_.resize(model.rings.slot_count(), none);
  ++epoch_;  // edits may not have been followed yet
  const auto add = [&](std::uint32_t a, const solver::AdvanceReport& last) {
    if (!model.articulates.is_alive(a) || !FreeBodies::is_free(model, a) || FreeBodies::is_particle(model, a)) return;
    borrow(model, a, [&](const Island& island) { found.push_back({a, island.report(model, last)}); });
  };
  for (const FreeBodies::Loose& loose : free_bodies_.loose()) add(loose.articulate, loose.report);
  free_bodies_.for_each_still([&](std::uint32_t body) { add(model.bodies[body].articulate, {}); });
  std::stable_sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  std::vector<IslandReport> reports;
  for (auto& [leader, report] : found) reports.push_back(std::move(report));
  return reports;
}

std::uint32_t Islands::resting(const Model& model) const {
  std::uint32_t count = asleep_ + free_bodies_.resting();
  for (const Island* const island : awake_)  // fell asleep in this step
    if (island->is_still() && island->is_asleep(model)) count += static_cast<std::uint32_t>(island->body_count());
  return count;
}

// Body by body takes several times as long as table by table.
bool Islands::renew_books(const Model& model, std::uint32_t frozen) {
  constexpr std::uint32_t share = 4;
  const bool may_be_of_still = model.has_edits == model::edits_of_any;
  if (may_be_of_still) ++book_epoch_, still_book_.reset();
  const std::uint32_t still = still_bodies_ + free_bodies_.still() + frozen;
  return !may_be_of_still && !order_is_old_ && !awake_is_old_ &&
         still >= model.bodies.size() - model.bodies.size() / share;
}

ingredient::Energies Islands::energies(const Model& model) {
  (void)awake(model), (void)loose(model);
  return renew_books(model, 0) ? sum_books(model).energies : ingredient::calc_energies(model);
}

// A restored system knows which loose ones are frozen from the end of its first step on.
ingredient::Book Islands::book(const Model& model) {
  return renew_books(model, free_bodies_.frozen()) ? sum_books(model) : ingredient::calc_book(model);
}

ingredient::Book Islands::sum_books(const Model& model) {
  if (!still_book_ || book_version_ != free_bodies_.version()) {
    still_book_.emplace();
    for (std::size_t index = 0; index < stills_.size(); ++index) {
      Still& still = stills_[index];
      if (!still.is) continue;
      if (std::exchange(still.book_epoch, book_epoch_) != book_epoch_)
        still.book = in_order_[index]->still_book(model, book_epoch_);
      still_book_->add(still.book);
    }
    free_bodies_.for_each_still(
        [&](std::uint32_t body) { still_book_->add(ingredient::calc_book(model, {&body, 1})); });
    book_version_ = free_bodies_.version();
  }
  ingredient::Book book = *still_book_;
  for (const Island* const island : awake_) book.add(ingredient::calc_book(model, island->bodies()));
  free_bodies_.add_awake(model, book_epoch_, book);
  return book;
}

std::size_t Islands::grain(const Parallel& parallel) const {
  // A second thread takes about 20 us to start; a point takes about a quarter of a microsecond. If one island is most
  // of the work, threads do not help.
  constexpr std::size_t worthwhile = 400, of_loose = 4;  // points
  const std::size_t loose = free_bodies_.loose().size(), count = awake_.size() + loose;
  const std::size_t points = total_size_ + of_loose * loose;
  if (parallel.threads() == 1 || points - largest_size_ < worthwhile) return count;
  return std::max<std::size_t>(1, count * 64 / points);
}

}  // namespace iota::island
