// SPDX-License-Identifier: Apache-2.0
#include "island/islands.h"

#include "ingredient/followers.h"

#include <algorithm>

namespace iota::island {

using model::Model;
using model::none;

void Islands::forget() {
  island_of_leader_.clear(), leader_of_.clear(), next_member_.clear(), is_waiting_.clear();
  members_.clear(), is_member_.clear();
  followed_.clear();
  free_particles_.forget();
  knows_all_ = false, order_is_old_ = true;
}

void Islands::renew() {
  renew_ = true;
  for (const auto& island : island_of_leader_)
    if (island) island->forget_factors();
}

// Its articulates will get a new one.
void Islands::drop(std::uint32_t leader) {
  island_of_leader_[leader].reset();
  std::erase_if(followed_, [&](const Followed& f) { return f.leader == leader; });
  for (std::uint32_t a = leader; a != none; a = next_member_[a]) {
    leader_of_[a] = none;
    if (!is_waiting_[a]) is_waiting_[a] = 1, waiting_.push_back(a);
  }
}

// With all articulates of its island.
void Islands::put_on_waiting_list(std::uint32_t articulate) {
  if (leader_of_[articulate] != none)
    drop(leader_of_[articulate]);
  else if (!is_waiting_[articulate])
    is_waiting_[articulate] = 1, waiting_.push_back(articulate);
}

// `members_` become one island.
void Islands::set_members(std::uint32_t leader) {
  for (std::size_t m = 0; m < members_.size(); ++m) {
    free_particles_.set(members_[m], false);
    leader_of_[members_[m]] = leader;
    next_member_[members_[m]] = m + 1 < members_.size() ? members_[m + 1] : none;
  }
}

// Puts the articulates of an island's bodies into `members_`. False if a body is gone, or they have other bodies, too.
bool Islands::find_members(const Island& island, const Model& model) {
  for (const std::uint32_t a : members_) is_member_[a] = 0;
  members_.clear();
  std::size_t expected = 0;
  for (const std::uint32_t body : island.bodies()) {
    if (!model.bodies.is_alive(body)) return false;
    const std::uint32_t a = model.bodies[body].articulate;
    if (is_member_[a]) continue;
    is_member_[a] = 1;
    members_.push_back(a);
    expected += model.articulates[a].count;
  }
  std::sort(members_.begin(), members_.end());
  return expected == island.bodies().size();
}

// An island of which only a few bodies changed may follow. It then still contains parts that were cut off.
bool Islands::follow(Model& model, std::uint32_t old_leader, MovedRings& moved) {
  constexpr std::size_t smallest = 64;  // points: smaller ones are built anew as quickly
  Island& island = *island_of_leader_[old_leader];
  if (island.size() < smallest || !find_members(island, model)) return false;
  const auto is_member = [&](std::uint32_t a) { return is_member_[a] != 0; };
  for (std::size_t i = 0; i < touched_.articulates.size(); ++i)
    if (!touched_.only_locally[i] && is_member(touched_.articulates[i])) return false;
  change_.bodies.clear();
  for (const std::uint32_t body : touched_.local.bodies)
    if (model.bodies.is_alive(body) && is_member(model.bodies[body].articulate)) change_.bodies.push_back(body);
  ingredient::sort_unique(change_.bodies);
  change_.rings = touched_.local.rings, change_.pulled = touched_.local.pulled;
  for (const std::uint32_t body : change_.bodies) make_ready(model, body);
  ingredient::follow_bases(model);
  if (!island.follow(model, members_, change_, node_of_ring_, moved)) return false;

  auto holder = std::move(island_of_leader_[old_leader]);
  for (std::uint32_t a = old_leader; a != none; a = next_member_[a]) leader_of_[a] = none;
  const std::uint32_t leader = members_.front();
  set_members(leader);
  island_of_leader_[leader] = std::move(holder);
  std::erase_if(followed_, [&](const Followed& f) { return f.leader == old_leader; });
  followed_.push_back({leader, model.step});
  return true;
}

// Parts that were cut off get their own islands after some steps without edits.
bool Islands::is_due(const Followed& followed, const Model& model) const {
  constexpr std::uint64_t calm = 120;  // steps
  return renew_ || (followed.step + calm <= model.step && next_member_[followed.leader] != none);
}

// Prepares data and table rows of an island before the parallel build.
void Islands::make_ready(Model& model, std::uint32_t body) {
  model.prefer_unknowns(body);
  ingredient::prepare(model, body);
}

bool Islands::update(Model& model, const Parallel& parallel, MovedRings& moved) {
  model.take_touched(touched_);
  if (!knows_all_) {
    touched_.articulates.clear();
    model.articulates.for_each([&](std::uint32_t a, const model::Articulate&) { touched_.articulates.push_back(a); });
    touched_.only_locally.assign(touched_.articulates.size(), 0);
    knows_all_ = true;
  }
  const bool any_is_due =
      std::any_of(followed_.begin(), followed_.end(), [&](const Followed& f) { return is_due(f, model); });
  if (touched_.articulates.empty() && touched_.local.pulled.empty() && !any_is_due) return false;
  order_is_old_ = awake_is_old_ = true;
  const std::size_t slots = model.articulates.slot_count();
  island_of_leader_.resize(slots), leader_of_.resize(slots, none), next_member_.resize(slots, none);
  is_waiting_.resize(slots, 0), is_member_.resize(slots, 0);
  node_of_ring_.resize(model.rings.slot_count(), none);

  follow_or_drop_touched(model, moved);
  renew_pulls(model);
  gather_waiting(model);
  build_fresh(model, parallel, moved);
  return !fresh_.empty();
}

// 1. Touched articulates, and all others of their islands, lose their island, unless it can follow.
void Islands::follow_or_drop_touched(Model& model, MovedRings& moved) {
  waiting_.clear();
  for (const Followed& f : std::vector<Followed>(followed_))
    if (is_due(f, model)) put_on_waiting_list(f.leader);
  renew_ = false;
  for (std::size_t i = 0; i < touched_.articulates.size(); ++i)
    if (!touched_.only_locally[i]) put_on_waiting_list(touched_.articulates[i]);
  std::vector<Island*> done;
  for (std::size_t i = 0; i < touched_.articulates.size(); ++i) {
    const std::uint32_t a = touched_.articulates[i];
    if (!touched_.only_locally[i] || leader_of_[a] == none) continue;
    Island* const island = island_of_leader_[leader_of_[a]].get();
    if (std::find(done.begin(), done.end(), island) != done.end()) continue;
    if (follow(model, leader_of_[a], moved))
      done.push_back(island);
    else
      put_on_waiting_list(a);
  }
  for (const std::uint32_t a : touched_.articulates)  // made by a cut that no island followed
    if (leader_of_[a] == none) put_on_waiting_list(a);
}

void Islands::renew_pulls(const Model& model) {
  for (const std::uint32_t body : touched_.local.pulled) {
    if (!model.bodies.is_alive(body)) continue;
    const std::uint32_t a = model.bodies[body].articulate;
    Island* const island = of_articulate(a);  // null: it will be built, with its pulls
    if (island && !island->renew_pulls(model, node_of_ring_)) put_on_waiting_list(a);
  }
}

// 2. Articulates that implicit bonds and constraints tie together are solved together: a search from each.
void Islands::gather_waiting(const Model& model) {
  fresh_.clear();
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    if (!is_waiting_[waiting_[i]]) continue;  // an earlier search has found it
    const bool alive = model.articulates.is_alive(waiting_[i]);
    const bool free = alive && FreeParticles::is_free(model, waiting_[i]);
    free_particles_.set(waiting_[i], free);
    is_waiting_[waiting_[i]] = 0;
    if (!alive || free) continue;
    for (const std::uint32_t a : members_) is_member_[a] = 0;
    members_.assign(1, waiting_[i]);
    for (std::size_t next = 0; next < members_.size(); ++next)
      model.for_each_body_of(members_[next], [&](std::uint32_t body) {
        model.for_each_particle_of(body, [&](std::uint32_t p) {
          const auto reach = [&](std::uint32_t far) {
            const std::uint32_t a = model.bodies[far].articulate;
            if (leader_of_[a] != none) drop(leader_of_[a]);
            if (free_particles_.contains(a)) free_particles_.set(a, false), is_waiting_[a] = 1;  // no longer free
            if (is_waiting_[a]) is_waiting_[a] = 0, members_.push_back(a);
          };
          model.visit_tied(p, Model::Ties::all, reach);
        });
      });
    std::sort(members_.begin(), members_.end());  // so that the result does not depend on the order of discovery
    set_members(members_.front());
    fresh_.push_back(members_.front());
  }
}

// 3. Each is built separately, in parallel if there are many.
void Islands::build_fresh(Model& model, const Parallel& parallel, MovedRings& moved) {
  for (const std::uint32_t leader : fresh_) {
    island_of_leader_[leader] = std::make_unique<Island>();
    for (std::uint32_t a = leader; a != none; a = next_member_[a])
      model.for_each_body_of(a, [&](std::uint32_t body) { make_ready(model, body); });
  }
  ingredient::follow_bases(model);
  std::vector<MovedRings> moved_by(fresh_.size(), MovedRings{.is_asked_for = moved.is_asked_for});
  parallel.for_each(fresh_.size(), 8, [&](std::size_t i) {
    std::vector<std::uint32_t> members;
    for (std::uint32_t a = fresh_[i]; a != none; a = next_member_[a]) members.push_back(a);
    Island& island = *island_of_leader_[fresh_[i]];
    island.assemble(model, members, node_of_ring_);
    island.carry_along(model, moved_by[i]);
  });
  for (const MovedRings& part : moved_by)
    moved.before.insert(moved.before.end(), part.before.begin(), part.before.end());
}

void Islands::replace_by_leaders(std::vector<std::uint32_t>& articulates) const {
  for (std::uint32_t& a : articulates) a = leader_of_[a];
  std::sort(articulates.begin(), articulates.end());
  articulates.erase(std::unique(articulates.begin(), articulates.end()), articulates.end());
  if (!articulates.empty() && articulates.back() == none) articulates.pop_back();  // free particles have no island
}

std::span<Island* const> Islands::all() {
  if (order_is_old_) {
    in_order_.clear();
    for (const auto& island : island_of_leader_)
      if (island) in_order_.push_back(island.get());
    order_is_old_ = false;
  }
  return in_order_;
}

void Islands::refresh_awake(const Model& model) {
  awake_.clear();
  still_book_.reset();
  total_size_ = largest_size_ = asleep_ = still_bodies_ = 0;
  for (Island* const island : all()) {
    if (island->is_still()) {
      island->skip_step();
      still_bodies_ += static_cast<std::uint32_t>(island->body_count());
      if (island->is_asleep(model)) asleep_ += static_cast<std::uint32_t>(island->body_count());
      continue;
    }
    awake_.push_back(island);
    total_size_ += island->size();
    largest_size_ = std::max(largest_size_, island->size());
  }
  awake_is_old_ = false;
}

std::span<Island* const> Islands::awake(const Model& model) {
  const auto is_still = [](const Island* island) { return island->is_still(); };
  if (order_is_old_ || awake_is_old_ || std::any_of(awake_.begin(), awake_.end(), is_still)) refresh_awake(model);
  return awake_;
}

void Islands::wake(Model& model, std::span<const std::uint32_t> articulates) {
  for (const std::uint32_t articulate : articulates) {
    Island* const island = of_articulate(articulate);
    if (!island)
      free_particles_.wake(model, articulate);
    else
      awake_is_old_ = awake_is_old_ || island->is_still(), island->wake();
  }
}

void Islands::wake_stirred(Model& model) {
  ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() {
    I::visit_stirred(model, [&](std::uint32_t ring) {
      model.for_each_in_ring(ring, [&](std::uint32_t p) {
        const std::uint32_t articulate = model.bodies[model.particles[p].body].articulate;
        const Island* const island = of_articulate(articulate);
        if (island ? island->is_still() : free_particles_.is_resting(model, articulate)) wake(model, {&articulate, 1});
      });
    });
  });
}

void Islands::put_to_rest(Model& model, std::uint32_t articulate) {
  if (Island* const island = of_articulate(articulate))
    island->put_to_rest(model);
  else
    free_particles_.put_to_rest(model, articulate);
}

std::uint32_t Islands::resting(const Model& model) const {
  std::uint32_t count = asleep_ + free_particles_.resting();
  for (const Island* const island : awake_)  // fell asleep in this step
    if (island->is_still() && island->is_asleep(model)) count += static_cast<std::uint32_t>(island->body_count());
  return count;
}

ingredient::Book Islands::book(const Model& model) {
  if (model.has_edits) ++book_epoch_, still_book_.reset();
  // Body by body takes several times as long as table by table.
  constexpr std::uint32_t share = 4;
  const std::uint32_t still = still_bodies_ + free_particles_.still();
  if (model.has_edits || order_is_old_ || awake_is_old_ || still < model.bodies.size() - model.bodies.size() / share)
    return ingredient::calc_book(model);
  if (!still_book_ || book_version_ != free_particles_.version()) {
    still_book_.emplace();
    auto awake = awake_.begin();
    for (Island* const island : in_order_)
      if (awake != awake_.end() && *awake == island)
        ++awake;
      else
        still_book_->add(island->still_book(model, book_epoch_));
    free_particles_.for_each_still(
        [&](std::uint32_t body) { still_book_->add(ingredient::calc_book(model, {&body, 1})); });
    book_version_ = free_particles_.version();
  }
  ingredient::Book book = *still_book_;
  for (const Island* const island : awake_) book.add(ingredient::calc_book(model, island->bodies()));
  free_particles_.for_each_awake([&](std::uint32_t body) { book.add(ingredient::calc_book(model, {&body, 1})); });
  return book;
}

std::size_t Islands::grain(const Parallel& parallel) const {
  // A second thread takes about 20 us to start; a point takes about a quarter of a microsecond. If one island is most
  // of the work, threads do not help.
  constexpr std::size_t worthwhile = 400;  // points
  if (parallel.threads() == 1 || total_size_ - largest_size_ < worthwhile) return awake_.size();
  return std::max<std::size_t>(1, awake_.size() * 64 / total_size_);
}

}  // namespace iota::island
