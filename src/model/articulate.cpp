// SPDX-License-Identifier: Apache-2.0
#include "model/structure.h"

#include "base/sort_unique.h"

#include <algorithm>

namespace iota::model {

void Structure::wake_all() {
  articulates.for_each([&](std::uint32_t slot, const Articulate&) { wake(slot); });
}

void Structure::take_flagged(std::vector<std::uint32_t>& taken) {
  taken.clear();
  if (flagged_.empty()) return;
  taken.swap(flagged_);
  sort_unique(taken);
  std::erase_if(taken, [&](std::uint32_t slot) { return !articulates.is_alive(slot); });
}

void Structure::list_flagged() {
  flagged_.clear();
  articulates.for_each([&](std::uint32_t slot, const Articulate& a) {
    if (a.to_wake || a.velocity_dirty) flagged_.push_back(slot);
  });
}

void Structure::mark(std::uint32_t articulate, Mark what, bool wakes) {
  if (wakes) wake(articulate);
  Articulate& a = articulates[articulate];
  ++a.version;
  // Among moving bodies contacts begin and end in each step: what has just had no solution would be tried each time.
  if (wakes)
    a.try_again();
  else
    a.standing_gap = 0;
  if (mark_of_.size() <= articulate) mark_of_.resize(articulates.slot_count(), unmarked);
  Mark& marked = mark_of_[articulate];
  if (marked == unmarked) marked_.push_back(articulate);
  marked = std::max(marked, what);
}

void Structure::mark_locally(std::uint32_t body) {
  note_body(body);
  mark_rows(body);
}

void Structure::mark_rows(std::uint32_t body, bool wakes) {
  const bool is_listed = lists_local_changes();
  if (is_listed && (local_change_.bodies.empty() || local_change_.bodies.back() != body))
    local_change_.bodies.push_back(body);
  mark(bodies[body].articulate, is_listed ? locally : anything, wakes);
}

void Structure::mark_pull(std::uint32_t body) {
  wake(bodies[body].articulate);
  articulates[bodies[body].articulate].try_again();
  local_change_.pulled.push_back(body);
}

void Structure::mark_ring(std::uint32_t ring, std::uint32_t split_from) {
  const bool is_listed = lists_local_changes();
  // If it is not, the bodies of the ring are in islands that are assembled anew.
  if (is_listed || rings[ring].count == 0) local_change_.rings.push_back({ring, split_from});
  std::uint32_t articulate = none;  // of all of them, unless they will be hinged
  for_each_in_ring(ring, [&](std::uint32_t p) {
    const std::uint32_t body = particles[p].body;
    if (is_listed) local_change_.bodies.push_back(body);
    note_body(body);
    if (bodies[body].articulate == articulate) return;
    articulate = bodies[body].articulate;
    mark(articulate, is_listed ? locally : anything);
  });
}

void Structure::take_marked(Marked& taken) {
  const auto is_empty = [](const LocalChange& c) {
    return c.bodies.empty() && c.rings.empty() && c.pulled.empty() && c.reborn.empty();
  };
  if (marked_.empty() && taken.articulates.empty() && is_empty(local_change_) && is_empty(taken.local)) return;
  // The room of the lists is used again, unless it is that of a scene that was built at once.
  const auto clear = [](auto& list) {
    constexpr std::size_t most_kept = 4096;
    list.clear();
    if (list.capacity() > most_kept) list.shrink_to_fit();
  };
  clear(taken.articulates), clear(taken.only_locally);
  clear(taken.local.bodies), clear(taken.local.rings), clear(taken.local.pulled);
  clear(taken.local.reborn);
  taken.articulates.swap(marked_);
  taken.local.bodies.swap(local_change_.bodies), taken.local.rings.swap(local_change_.rings);
  taken.local.pulled.swap(local_change_.pulled), taken.local.reborn.swap(local_change_.reborn);
  for (const std::uint32_t slot : taken.articulates) {
    taken.only_locally.push_back(mark_of_[slot] == locally);
    mark_of_[slot] = unmarked;
  }
}

// The smaller list is appended to the larger; only its bodies are relabeled.
void Structure::join_articulates(std::uint32_t a, std::uint32_t b) {
  if (a == b) return;
  if (articulates[a].count < articulates[b].count) std::swap(a, b);
  mark(a, locally), mark(b, locally);
  mark_of_[a] = std::max(mark_of_[a], mark_of_[b]);
  Articulate &into = articulates[a], &from = articulates[b];
  for_each_body_of(b, [&](std::uint32_t body) {
    bodies[body].articulate = a;
    scene.memberships.note(body);
  });
  bodies[from.first].previous_in_articulate = into.last;
  bodies[into.last].next_in_articulate = from.first;
  into.last = from.last;
  into.count += from.count, into.owed_work += from.owed_work;
  if (from.velocity_dirty) mark_velocities(a);
  articulates.destroy(b);
}

namespace {

/// From one articulate to another.
void move_bodies(Structure& model, std::span<const std::uint32_t> moved, std::uint32_t from, std::uint32_t into) {
  Articulate &a = model.articulates[from], &b = model.articulates[into];
  for (const std::uint32_t slot : moved) {
    Body& body = model.bodies[slot];
    const std::uint32_t before = body.previous_in_articulate, after = body.next_in_articulate;
    (before == none ? a.first : model.bodies[before].next_in_articulate) = after;
    (after == none ? a.last : model.bodies[after].previous_in_articulate) = before;
    (b.last == none ? b.first : model.bodies[b.last].next_in_articulate) = slot;
    body.previous_in_articulate = b.last, body.next_in_articulate = none;
    body.articulate = into;
    b.last = slot;
  }
  const auto count = static_cast<std::uint32_t>(moved.size());
  a.count -= count, b.count += count;
  if (model.scene.is_on())
    for (const std::uint32_t slot : moved) model.scene.memberships.note(slot);
}

}  // namespace

bool Structure::split_articulate(std::uint32_t body_a, std::uint32_t body_b) {
  if (body_a == body_b) return false;
  // Two breadth-first floods in turn, each a list of bodies that also serves as its queue. A mark says whose a body is.
  // All bodies of a ring are found together, so the ring by which a body was found need not be visited again: the second
  // half of a flood lists the particles in these rings.
  Marks& marks = body_marks_;
  const std::size_t slots = bodies.slot_count();
  if (marks.of.size() < slots) {
    marks.of.resize(slots, 0);
    for (std::vector<std::uint32_t>& flood : floods_) flood.resize(2 * slots);
  }
  if (marks.current > 0xfffffff0u) std::fill(marks.of.begin(), marks.of.end(), marks.current = 0);
  const std::uint32_t first_mark = marks.current + 1;
  marks.current += 2;
  std::uint32_t* const mark_of = marks.of.data();
  const std::size_t half = floods_[0].size() / 2;
  const std::array flood{floods_[0].data(), floods_[1].data()};
  std::array<std::size_t, 2> next{0, 0}, end{1, 1};
  flood[0][0] = body_a, flood[0][half] = none, mark_of[body_a] = first_mark;
  flood[1][0] = body_b, flood[1][half] = none, mark_of[body_b] = first_mark + 1;
  // From the smaller body first: if that is all of its side, the other one is not looked at.
  std::uint32_t which = bodies[body_a].count <= bodies[body_b].count ? 1 : 0;  // the other one's turn
  bool met = false, has_all = false;
  while (!met && !has_all) {
    which = 1 - which;
    const std::uint32_t own_mark = first_mark + which;
    std::uint32_t *const found = flood[which], *const found_by = found + half;
    const auto reach = [=](std::uint32_t body, std::uint32_t by, std::size_t& count, bool& meets) {
      if (mark_of[body] < first_mark)
        mark_of[body] = own_mark, found[count] = body, found_by[count++] = by;
      else
        meets = meets || mark_of[body] != own_mark;
    };
    std::size_t count = end[which];
    bool meets = false;
    const std::uint32_t visited = found_by[next[which]];
    for (std::uint32_t p = bodies[found[next[which]++]].first; p != none;) {
      const Particle& particle = particles[p];
      if (p != visited && rings[particle.ring].count > 1)
        for (std::uint32_t q = rings[particle.ring].first; q != none; q = particles[q].next_in_ring)
          if (q != p) reach(particles[q].body, q, count, meets);
      if (particle.uses > 0) {       // joins count as uses
        std::size_t joined = count;  // so that `count` can be in a register
        bool joined_meets = meets;
        visit_joined(p,
                     [reach, &joined, &joined_meets](std::uint32_t body) { reach(body, none, joined, joined_meets); });
        count = joined, meets = joined_meets;
      }
      p = particle.next_in_body;
    }
    end[which] = count, met = meets, has_all = next[which] == count;
  }
  if (met) return false;

  const std::uint32_t own = articulates.create({}).slot;
  const std::uint32_t whole = bodies[body_a].articulate;
  if (articulates[whole].velocity_dirty) mark_velocities(own);
  mark(whole, locally), mark(own, locally);
  mark_of_[own] = std::max(mark_of_[own], mark_of_[whole]);
  move_bodies(*this, {flood[which], end[which]}, whole, own);
  return true;
}

}  // namespace iota::model
