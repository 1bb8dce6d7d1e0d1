// SPDX-License-Identifier: Apache-2.0
#include "model/model.h"

#include <unordered_map>

namespace iota::model {

void Model::join_articulates(std::uint32_t a, std::uint32_t b) {
  if (a == b) return;
  if (articulates[a].count < articulates[b].count) std::swap(a, b);
  while (articulates[b].count > 1) {
    const std::uint32_t body = articulates[b].first;
    take_from_articulate(body);
    add_to_articulate(body, a);
  }
  const std::uint32_t body = articulates[b].first;  // the last one takes the articulate with it
  take_from_articulate(body);
  add_to_articulate(body, a);
}

bool Model::split_articulate(std::uint32_t body_a, std::uint32_t body_b) {
  if (body_a == body_b) return false;
  // Two breadth-first floods in turn, each a list of bodies that also serves as its queue.
  struct Flood {
    std::vector<std::uint32_t> reached;
    std::size_t next = 0;
  };
  std::array<Flood, 2> floods;
  std::unordered_map<std::uint32_t, int> side{{body_a, 0}, {body_b, 1}};
  floods[0].reached.push_back(body_a);
  floods[1].reached.push_back(body_b);

  bool met = false;
  const auto reach = [&](int which, std::uint32_t body) {
    const auto [found, is_new] = side.try_emplace(body, which);
    if (is_new)
      floods[which].reached.push_back(body);
    else
      met = met || found->second != which;
  };
  const auto advance = [&](int which) {
    for_each_particle_of(floods[which].reached[floods[which].next++], [&](std::uint32_t p) {
      for_each_in_ring(particles[p].ring, [&](std::uint32_t hinged) { reach(which, particles[hinged].body); });
      if (particles[p].uses == 0 || closings.size() == 0) return;
      closings.for_each([&](std::uint32_t, const Closing& c) {  // on their way to each other: already one problem
        if (c.p == p) reach(which, particles[c.q].body);
        if (c.q == p) reach(which, particles[c.p].body);
      });
    });
  };
  for (int which = 0; !met; which = 1 - which) {
    if (floods[which].next == floods[which].reached.size()) {
      const std::uint32_t own = articulates.create({}).slot;
      for (const std::uint32_t body : floods[which].reached) {
        take_from_articulate(body);
        add_to_articulate(body, own);
      }
      return true;
    }
    advance(which);
  }
  return false;
}

}  // namespace iota::model
