// SPDX-License-Identifier: Apache-2.0
#include "model/audit.h"

#include <algorithm>
#include <cmath>

namespace iota::model {

Audit::Audit(const Structure& model)
    : model_(model),
      uses_(model.particles.slot_count(), 0),
      in_body_(model.bodies.slot_count(), 0),
      in_ring_(model.rings.slot_count(), 0),
      in_articulate_(model.articulates.slot_count(), 0),
      parent_(model.bodies.slot_count()) {
  std::iota(parent_.begin(), parent_.end(), 0u);
}

std::uint32_t Audit::root(std::uint32_t body) {
  while (parent_[body] != body) body = parent_[body] = parent_[parent_[body]];
  return body;
}

void Audit::require_ends(const char* what, std::uint32_t slot, const Ends& ends) {
  require(model_.particles.is_alive(ends.p) && model_.particles.is_alive(ends.q) && ends.p != ends.q, what, " ", slot,
          " joins ", ends.p, " and ", ends.q);
}

void Audit::require_group(const char* what, std::uint32_t slot, std::uint32_t group) {
  require(group == none || model_.groups.is_alive(group), what, " ", slot, " acts on no living group");
}

void Audit::check_structure() {
  check_particles();
  check_rings();
  check_bodies();
  require_owners("a fuse", model_.fuses, model_.particles);
  model_.twins.for_each([&](std::uint32_t slot, const Twin& t) {
    require(model_.particles.is_alive(t.particle) && t.mass >= 0, "twin ", slot, " is of no living particle");
  });
}

void Audit::check_particles() {
  std::uint32_t living_groups = 0;
  model_.groups.for_each([&](std::uint32_t slot, const Group&) { living_groups |= 1u << slot; });
  model_.particles.for_each([&](std::uint32_t slot, const Particle& p) {
    const bool linked = model_.bodies.is_alive(p.body) && model_.rings.is_alive(p.ring);
    require(linked, "particle ", slot, " is in no living body or ring");
    require(p.mass >= 0 && std::isfinite(p.mass), "particle ", slot, " has mass ", p.mass);
    if (!linked) return;
    require(!p.is_marker() || (p.basis_index < 0 && model_.bodies[p.body].rank > 0), "marker ", slot,
            " is in its body's basis, or alone in it");
    ++in_body_[p.body], ++in_ring_[p.ring];
    require((p.groups & ~living_groups) == 0, "particle ", slot, " is in a group that is gone");
  });
}

void Audit::check_rings() {
  model_.rings.for_each([&](std::uint32_t slot, const Ring& r) {
    std::uint32_t walked = 0;
    std::vector<std::uint32_t> owners;
    model_.for_each_in_ring(slot, [&](std::uint32_t p) {
      ++walked;
      require(model_.particles.is_alive(p) && model_.particles[p].ring == slot, "ring ", slot, " lists stranger ", p);
      owners.push_back(model_.particles[p].body);
    });
    require(walked == r.count && walked == in_ring_[slot] && walked > 0, "ring ", slot, " counts ", r.count,
            " particles, lists ", walked, ", has ", in_ring_[slot]);
    std::sort(owners.begin(), owners.end());
    require(std::adjacent_find(owners.begin(), owners.end()) == owners.end(), "ring ", slot,
            " holds two particles of one body");
    require(is_finite(r.position) && is_finite(r.velocity), "ring ", slot, " is not finite");
  });
}

void Audit::check_bodies() {
  std::uint32_t listed_solids = 0;
  model_.bodies.for_each([&](std::uint32_t slot, const Body& b) {
    std::uint32_t walked = 0;
    model_.for_each_particle_of(slot, [&](std::uint32_t p) {
      ++walked;
      require(model_.particles.is_alive(p) && model_.particles[p].body == slot, "body ", slot, " lists stranger ", p);
    });
    require(walked == b.count && walked == in_body_[slot], "body ", slot, " counts ", b.count, " particles, lists ",
            walked, ", has ", in_body_[slot]);
    require(model_.articulates.is_alive(b.articulate), "body ", slot, " is in no living articulate");
    if (model_.articulates.is_alive(b.articulate)) ++in_articulate_[b.articulate];
    for (int i = 0; i < b.rank; ++i)
      require(model_.particles.is_alive(b.basis[i]) && model_.particles[b.basis[i]].body == slot &&
                  model_.particles[b.basis[i]].basis_index == i,
              "body ", slot, " has a wrong basis point ", i);
    model_.for_each_solid_of(slot, [&](std::uint32_t s) {
      ++listed_solids;
      require(model_.solids.is_alive(s) && model_.solids[s].body == slot, "solid ", s, " is not of body ", slot);
      for (const std::uint32_t p : model_.solids[s].points)
        require(model_.particles.is_alive(p) && model_.particles[p].body == slot, "solid ", s, " stands on stranger ",
                p);
    });
  });

  require(listed_solids == model_.solids.size(), "bodies list ", listed_solids, " solids of ", model_.solids.size());
}

void Audit::check_counts() {
  check_articulates();
  model_.particles.for_each([&](std::uint32_t slot, const Particle& p) {
    require(p.uses == uses_[slot], "particle ", slot, " counts ", p.uses, " uses, has ", uses_[slot]);
  });
  for (const auto& [item, count] : counts_)
    require(count.found == count.told, item.first, " ", item.second, " counts ", count.told, " uses, has ",
            count.found);
}

void Audit::check_articulates() {
  // Articulates are exactly the components of the hinge graph (an ingredient may tie bodies as hinges do).
  model_.rings.for_each([&](std::uint32_t, const Ring& r) {
    if (r.first == none) return;
    for (std::uint32_t p = model_.particles[r.first].next_in_ring; p != none; p = model_.particles[p].next_in_ring)
      parent_[root(model_.particles[p].body)] = root(model_.particles[r.first].body);
  });
  std::vector<std::uint32_t> articulate_of_root(model_.bodies.slot_count(), none),
      roots_of(model_.articulates.slot_count(), 0);
  model_.bodies.for_each([&](std::uint32_t slot, const Body& b) {
    const std::uint32_t r = root(slot);
    if (articulate_of_root[r] == none) articulate_of_root[r] = b.articulate, ++roots_of[b.articulate];
    require(articulate_of_root[r] == b.articulate, "bodies ", r, " and ", slot,
            " hang together but are in articulates ", articulate_of_root[r], " and ", b.articulate);
  });
  model_.articulates.for_each([&](std::uint32_t slot, const Articulate& a) {
    std::uint32_t walked = 0;
    model_.for_each_body_of(slot, [&](std::uint32_t b) {
      ++walked;
      require(model_.bodies.is_alive(b) && model_.bodies[b].articulate == slot, "articulate ", slot, " lists stranger ",
              b);
    });
    require(walked == a.count && walked == in_articulate_[slot] && walked > 0, "articulate ", slot, " counts ", a.count,
            " bodies, lists ", walked, ", has ", in_articulate_[slot]);
    require(roots_of[slot] == 1, "articulate ", slot, " holds ", roots_of[slot], " separate pieces");
  });
}

}  // namespace iota::model
