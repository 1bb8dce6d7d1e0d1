// SPDX-License-Identifier: Apache-2.0
#include "model/structure.h"

#include <algorithm>

namespace iota::model {

void Structure::touch(std::uint32_t articulate, Touch what) {
  ++articulates[articulate].version;
  articulates[articulate].disturbed = 1;
  articulates[articulate].standing_gap = 0;  // a conflict may be solvable now
  if (touch_of_.size() <= articulate) touch_of_.resize(articulates.slot_count(), untouched);
  if (touch_of_[articulate] == untouched) touched_.push_back(articulate);
  touch_of_[articulate] = std::max(touch_of_[articulate], what);
}

namespace {
constexpr std::size_t most_local_changes = 1024;  // after more of them islands are built anew
}

void Structure::touch_locally(std::uint32_t body) {
  const bool few = local_change_.bodies.size() < most_local_changes;
  if (few) local_change_.bodies.push_back(body);
  scene.bodies.note(body);
  touch(bodies[body].articulate, few ? locally : anything);
}

void Structure::touch_ring(std::uint32_t ring, std::uint32_t split_from) {
  // Without room the bodies of the ring are in islands that are built anew, and nobody asks for the ring.
  if (local_change_.bodies.size() < most_local_changes || rings[ring].count == 0)
    local_change_.rings.push_back({ring, split_from});
  for_each_in_ring(ring, [&](std::uint32_t p) { touch_locally(particles[p].body); });
}

void Structure::take_touched(Touched& taken) {
  taken.articulates.swap(touched_);
  std::swap(taken.local, local_change_);
  touched_.clear(), local_change_.bodies.clear(), local_change_.rings.clear(), taken.only_locally.clear();
  for (const std::uint32_t slot : taken.articulates) {
    taken.only_locally.push_back(touch_of_[slot] == locally);
    touch_of_[slot] = untouched;
  }
}

// The smaller list is hung behind the larger as it is; only its bodies have to learn where they are now.
void Structure::join_articulates(std::uint32_t a, std::uint32_t b) {
  if (a == b) return;
  if (articulates[a].count < articulates[b].count) std::swap(a, b);
  touch(a, locally), touch(b, locally);
  touch_of_[a] = std::max(touch_of_[a], touch_of_[b]);
  Articulate &into = articulates[a], &from = articulates[b];
  for_each_body_of(b, [&](std::uint32_t body) {
    bodies[body].articulate = a;
    scene.memberships.note(body);
  });
  bodies[from.first].previous_in_articulate = into.last;
  bodies[into.last].next_in_articulate = from.first;
  into.last = from.last;
  into.count += from.count;
  into.jolted |= from.jolted;
  articulates.destroy(b);
}

bool Structure::split_articulate(std::uint32_t body_a, std::uint32_t body_b) {
  if (body_a == body_b) return false;
  // Two breadth-first floods in turn, each a list of bodies that also serves as its queue. A mark says whose a body is.
  Marks& marks = body_marks_;
  marks.of.resize(bodies.slot_count(), 0);
  if (marks.current > 0xfffffff0u) std::fill(marks.of.begin(), marks.of.end(), marks.current = 0);
  const std::uint32_t first_mark = marks.current + 1;
  marks.current += 2;
  std::array<std::size_t, 2> next{};
  bool met = false;
  const auto reach = [&](std::uint32_t which, std::uint32_t body) {
    std::uint32_t& mark = marks.of[body];
    if (mark < first_mark) {
      mark = first_mark + which;
      floods_[which].push_back(body);
    } else {
      met = met || mark != first_mark + which;
    }
  };
  for (const std::uint32_t which : {0u, 1u}) floods_[which].clear(), reach(which, which ? body_b : body_a);
  const auto advance = [&](std::uint32_t which) {
    for_each_particle_of(floods_[which][next[which]++], [&](std::uint32_t p) {
      for_each_in_ring(particles[p].ring, [&](std::uint32_t hinged) {
        if (hinged != p) reach(which, particles[hinged].body);
      });
      visit_joined(p, [&](std::uint32_t body) { reach(which, body); });
    });
  };
  std::uint32_t which = 0;
  for (; !met && next[which] < floods_[which].size(); which = 1 - which) advance(which);
  if (met) return false;

  const std::uint32_t own = articulates.create({}).slot;
  const std::uint32_t whole = bodies[body_a].articulate;
  articulates[own].jolted = articulates[whole].jolted;
  touch(whole, locally), touch(own, locally);
  touch_of_[own] = std::max(touch_of_[own], touch_of_[whole]);
  for (const std::uint32_t body : floods_[which]) {
    leave_articulate(body);
    enter_articulate(body, own);
  }
  return true;
}

}  // namespace iota::model
